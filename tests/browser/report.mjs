// A report (softkin fk --html) with a map: all of it works from the file alone, with the results of softkin.
import assert from 'node:assert/strict';
import {execFile} from 'node:child_process';
import {readFileSync, statSync, writeFileSync} from 'node:fs';
import {resolve} from 'node:path';
import {pathToFileURL} from 'node:url';
import {promisify} from 'node:util';
import {drag, dropFile, frames, moveSlider, open, tip, tipOnScreen, tipText, violations} from './browser.mjs';
import {example, forward, mapOf, out, softkin} from './softkin.mjs';

const name = 'three_tendon_finger', actuators = ['tendon1', 'tendon2', 'tendon3'];
const sizes = [[1280, 720], [1920, 1080], [390, 844]];
const distance = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));
const text = (page, id) => page.locator(`#${id}`).textContent();

/** Returns reproducible commands at the steps of the sliders. */
function someCommands(count) {
  let state = 12345;
  const next = () => (state = (state * 1103515245 + 12345) % 2 ** 31) / 2 ** 31;
  const one = () => Number((0.6 + 0.0005 * Math.round(800 * next())).toFixed(4));
  return Array.from({length: count}, () => actuators.map(one));
}

async function checkNumbers(page, map) {
  const rows = someCommands(10), solved = await forward(example(name), actuators, rows);
  const mapped = await forward(example(name), actuators, rows, '--map', map);
  for (const [r, row] of rows.entries()) {
    for (const [a, value] of row.entries()) await moveSlider(page, a, value);
    const shown = await tip(page), exact = solved[r].markers.tip;
    assert.ok(distance(shown, exact) < 0.05, `at ${row} the page shows ${shown}, softkin fk ${exact}`);
    const digits = mapped[r].markers.tip.map((x) => (Math.abs(x) < 0.005 ? 0 : x).toFixed(2).replace('-', '−'));
    assert.deepEqual(await tipText(page), digits, `at ${row}`);
  }
}

async function checkTarget(page) {
  await moveSlider(page, 0, 0.75);
  await moveSlider(page, 1, 0.8);
  await moveSlider(page, 2, 0.9);
  await frames(page);
  const before = await tip(page), at = await tipOnScreen(page);
  await drag(page, at, {x: at.x - 12, y: at.y + 10});
  const after = await tip(page);
  assert.ok(distance(before, after) > 1, 'the marker did not follow the pointer');
  await page.locator('#undo').click();
  assert.ok(distance(await tip(page), before) < 0.011, 'undo does not restore the position');
  await frames(page);
  const letter = await page.locator('#labels b').nth(0).boundingBox(), mark = await tipOnScreen(page);
  const arrow = {x: mark.x + 0.6 * (letter.x + 4 - mark.x), y: mark.y + 0.6 * (letter.y + 9 - mark.y)};
  await drag(page, arrow, {x: arrow.x - 0.3 * (letter.x - mark.x), y: arrow.y - 0.3 * (letter.y + 9 - mark.y)});
  const target = await page.locator('#target input').evaluateAll((fields) => fields.map(({value}) => Number(value)));
  assert.ok(target[0] < before[0] - 1, 'the arrow along x does not move the target along x');
  assert.ok(Math.abs(target[1] - before[1]) < 0.011 && Math.abs(target[2] - before[2]) < 0.011, 'it moves aside');
  await page.locator('#target input').nth(1).fill('60');
  await page.keyboard.press('Enter');
  assert.match(await text(page, 'error'), /^Out of reach: tip is [\d.]+ mm/);
  assert.match(await page.locator('#error').getAttribute('class'), /bad/);
  await page.screenshot({path: out('report_out_of_reach.png')});
  await page.locator('#reset').click();
  for (const a of [0, 1, 2]) assert.equal(await page.locator(`#actuator-${a}`).inputValue(), '1');
}

async function checkFiles(page) {
  for (const [content, what] of [['tendon1\n0.8\nx', /Line 3: column tendon1 must hold a number/],
                                 ['tendon1\n0.4', /Line 2: column tendon1: 0.4 is outside its range, 0.5 to 1/],
                                 ['tendon9\n1', /Line 1: column tendon9 names no actuator/]]) {
    await dropFile(page, 'wrong.csv', content);
    assert.match(await page.locator('#path .bad').textContent(), what);
  }
  await dropFile(page, 'path.csv', readFileSync(example(name, 'path.csv'), 'utf8'));
  assert.equal(await page.locator('#path .bad').textContent(), '');
  assert.match(await page.locator('#path').textContent(), /9 rows of commands/);
  await page.locator('#step').fill('8');
  const last = (await forward(example(name), actuators, [[1, 0.8, 0.6]]))[0].markers.tip;
  assert.ok(distance(await tip(page), last) < 0.05, 'the last row gives another position');
  await dropFile(page, 'circle.csv', readFileSync(example(name, 'circle.csv'), 'utf8'));
  await page.waitForFunction(() => /(\d+) of \1 waypoints solved/.test(document.querySelector('#path').textContent));
  await page.waitForFunction(() => Number(document.querySelector('#step').value) > 2);
  await page.locator('#play').click();
  await page.locator('#step').fill('5');
  assert.match(await text(page, 'step-text'), /^6 of \d+, t = 2\.5 s$/);
  const line = readFileSync(example(name, 'circle.csv'), 'utf8').trim().split('\n')[6].split(',').map(Number);
  const [x, , z] = await tip(page);
  assert.ok(Math.hypot(x - line[1], z - line[2]) < 0.05, 'the waypoint is missed');
  await page.locator('#path svg').scrollIntoViewIfNeeded();
  await page.screenshot({path: out('report_waypoints.png')});
  await page.getByText('Close the file').click();
  assert.match(await text(page, 'step-text'), /8 computed steps/);
}

async function saved(page, button) {
  const [download] = await Promise.all([page.waitForEvent('download'), page.getByText(button).click()]);
  const file = out(download.suggestedFilename());
  await download.saveAs(file);
  return file;
}

async function checkSaving(page) {
  for (const [a, value] of [0.9, 0.7, 1].entries()) await moveSlider(page, a, value);
  const shown = await tip(page), state = readFileSync(await saved(page, 'State (YAML)'), 'utf8');
  assert.match(state, /commands:\n  "tendon1": 0.9\n  "tendon2": 0.7\n  "tendon3": 1\n/);
  await page.locator('#reset').click();
  await dropFile(page, 'my.state.yaml', state);
  assert.deepEqual(await tip(page), shown, 'the state is not shown again');
  const line = await page.locator('#save textarea').inputValue();
  assert.ok(state.includes(line));
  const shell = line.replace(/^softkin/, '"$SOFTKIN" ') + ' --json';
  const {stdout} = await promisify(execFile)('sh', ['-c', shell],
    {env: {...process.env, SOFTKIN: resolve(process.argv[2])}, maxBuffer: 1 << 28});
  assert.ok(distance(JSON.parse(stdout).steps[0].markers.tip, shown) < 0.05, 'the line computes another state');
  const vtu = readFileSync(await saved(page, 'Shape (VTU)'), 'utf8');
  const count = Number(/NumberOfPoints="(\d+)"/.exec(vtu)[1]);
  const points = /Name="Points"[^>]*>\n([^<]*)</.exec(vtu)[1].trim().split(' ').map(Number);
  assert.equal(points.length, 3 * count);
  assert.ok(points.every(Number.isFinite));
}

async function checkSteps(page) {
  await page.locator('#step').fill('0');
  assert.match(await text(page, 'state'), /^Step 1: converged, \d+ iterations/);
  await page.locator('#play').click();
  await page.waitForFunction(() => /^Step [3-9]/.test(document.querySelector('#state').textContent));
  await page.locator('#play').click();
  await page.locator('#colour').selectOption('strain');
  assert.match(await text(page, 'bar-title'), /strain \[%\]/);
  await page.locator('#colour').selectOption('displacement');
}

async function checkLooks(browser, url) {
  for (const [width, height] of sizes) for (const scheme of ['light', 'dark']) {
    const {page, watch, context} = await open(browser, url, {width, height, scheme});
    const at = `${width}x${height} ${scheme}`;
    await frames(page, 3);
    assert.deepEqual(await violations(page), [], at);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= width, `${at}: the page is ${wide} px wide`);
    await page.screenshot({path: out(`report_${width}x${height}_${scheme}.png`)});
    if (width < 600) await page.screenshot({path: out(`report_${width}_${scheme}_whole.png`), fullPage: true});
    assert.deepEqual([...watch.errors, ...watch.requests], [], at);
    await context.close();
  }
}

export async function reportTests(browser, test) {
  const map = await mapOf(name), file = out('report.html');
  const [head, , ...rows] = readFileSync(example(name, 'path.csv'), 'utf8').trim().split('\n');
  writeFileSync(out('path.csv'), [head, ...rows].join('\n'));
  await softkin('fk', example(name), '--path', out('path.csv'), '--map', map, '--html', file);
  const url = pathToFileURL(resolve(file)).href, {page, watch, context} = await open(browser, url);
  await test('report is smaller than 3 MB', () => assert.ok(statSync(file).size < 3e6, `${statSync(file).size} B`));
  await test('report: sliders give the positions of softkin fk', () => checkNumbers(page, map));
  await test('report: targets are dragged and typed, undone and reset', () => checkTarget(page));
  await test('report: files are dropped, played and scrubbed', () => checkFiles(page));
  await test('report: states and shapes are saved, and computed again', () => checkSaving(page));
  await test('report: steps are played and coloured', () => checkSteps(page));
  await test('report: no errors, no requests', () => assert.deepEqual([...watch.errors, ...watch.requests], []));
  await context.close();
  await test('report: accessible and fitting in all sizes and themes', () => checkLooks(browser, url));
}
