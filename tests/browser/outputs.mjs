// A page with a map shows the map's value of every output: markers, pressures, tensions, lengths and volumes.
import assert from 'node:assert/strict';
import {resolve} from 'node:path';
import {pathToFileURL} from 'node:url';
import {moveSlider, open} from './browser.mjs';
import {example, mapOf, out, softkin} from './softkin.mjs';

/** Examples: a chamber by pressure, tendons by length, chambers by volume, one cable. */
const robots = ['paper_finger', 'three_tendon_finger', 'three_chamber_actuator', 'cable_gripper'];

/** Returns reproducible commands at thousandths of the ranges, the steps of the sliders. */
function someCommands(inputs, count) {
  let state = 4321;
  const next = () => (state = (state * 1103515245 + 12345) % 2 ** 31) / 2 ** 31;
  return Array.from({length: count}, () =>
    inputs.map(({low, high}) => Number((low + (high - low) * Math.round(1000 * next()) / 1000).toPrecision(12))));
}

const number = (text) => Number(text.replace('−', '-'));
const quantities = {pressure: ['pressure'], tension: ['tension'], ratio: ['length', 'area', 'volume']};

/** Returns the values on the page by the names of the map's outputs. */
async function shown(page) {
  const texts = (table) => page.locator(`#${table} tbody tr`).evaluateAll((rows) =>
    rows.map((row) => [...row.querySelectorAll('td')].map((cell) => cell.textContent)));
  const numbers = new Map();
  for (const [name, ...places] of await texts('table'))
    'xyz'.split('').forEach((axis, k) => numbers.set(`${name} ${axis}`, number(places[k])));
  for (const [name, quantity, value] of await texts('outputs')) {
    const [ending] = Object.entries(quantities).find(([, words]) => words.includes(quantity));
    numbers.set(`${name} ${ending}`, number(value));
  }
  return numbers;
}

async function checkOutputs(browser, name) {
  const map = await mapOf(name), file = out(`outputs_${name}.html`), module = out(`outputs_${name}.mjs`);
  await softkin('fk', example(name), '--map', map, '--html', file);
  await softkin('map', 'export', map, '--js', module);
  const {fk, inputs, outputs} = await import(pathToFileURL(resolve(module)).href);
  const {page, watch, context} = await open(browser, pathToFileURL(resolve(file)).href);
  const actuators = await page.evaluate(() =>
    JSON.parse(document.querySelector('#softkin-page').textContent).actuators.map((actuator) => actuator.name));
  const seen = new Map(outputs.map((output) => [output.name, new Set()]));
  for (const commands of someCommands(inputs, 5)) {
    for (const [i, input] of inputs.entries()) await moveSlider(page, actuators.indexOf(input.name), commands[i]);
    const expected = fk(commands);
    if (!expected) continue;
    const numbers = await shown(page);
    outputs.forEach(({name: output, unit}, q) => {
      const value = expected.outputs[q], label = output.replaceAll('_', ' ');
      assert.ok(numbers.has(label), `${name}: the page does not show ${output}`);
      const rounded = unit === 'mm' ? 0.0051 : 6e-5 * Math.max(Math.abs(value), 1e-3);
      assert.ok(Math.abs(numbers.get(label) - value) <= rounded,
                `${name} at ${commands}: ${output} is ${value}, the page shows ${numbers.get(label)}`);
      seen.get(output).add(numbers.get(label));
    });
  }
  assert.ok([...seen.values()].some((values) => values.size > 1), `${name}: nothing moves`);
  await page.locator('#outputs-section').scrollIntoViewIfNeeded();
  await page.screenshot({path: out(`outputs_${name}.png`)});
  assert.deepEqual([...watch.errors, ...watch.requests], []);
  await context.close();
}

export async function outputTests(browser, test) {
  for (const name of robots)
    await test(`outputs: the page of ${name} shows those of its map`, () => checkOutputs(browser, name));
}
