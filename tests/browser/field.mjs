// The arrow of the magnetic field: it shows the field that the sliders command, and dragging it sets their commands.
import assert from 'node:assert/strict';
import {resolve} from 'node:path';
import {pathToFileURL} from 'node:url';
import {drag, frames, moveSlider, open, tip, tipText, violations} from './browser.mjs';
import {example, forward, mapOf, out, serve, softkin} from './softkin.mjs';

const crawler = 'magnetic_crawler', cantilever = 'magnetic_cantilever';
const distance = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));
/** Returns the text of the arrow's label, which is written when a frame is drawn. */
async function size(page) {
  await frames(page);
  return page.locator('#labels .field').textContent();
}

/** Returns a command from its field: sliders round. */
const command = async (page, a) => Number(await page.locator('.typed input').nth(a).inputValue());

/** Returns the tip of the field's arrow on the screen. */
async function endOnScreen(page) {
  await frames(page);
  const box = await page.locator('#canvas').boundingBox();
  const moved = await page.locator('#labels .field').evaluate((label) => label.style.transform);
  const [x, y] = /translate\((.*)px, (.*)px\)/.exec(moved).slice(1).map(Number);
  return {x: box.x + x, y: box.y + y};
}

const apart = (a, b) => Math.hypot(a.x - b.x, a.y - b.y);

async function dragBy(page, x, y) {
  const at = await endOnScreen(page), to = {x: at.x + x, y: at.y + y};
  await drag(page, at, to);
  return apart(await endOnScreen(page), to);
}

async function checkSteps(page) {
  const ends = [];
  for (const step of [0, 1, 2]) {
    await page.locator('#step').fill(String(step));
    ends.push(await endOnScreen(page));
  }
  assert.ok(apart(ends[0], ends[1]) > 5 && apart(ends[1], ends[2]) > 5, 'steps do not move the arrow');
  assert.match(await size(page), /^field 1\.20 mT/);
}

async function checkDrag(page) {
  await moveSlider(page, 0, 0);
  await moveSlider(page, 1, 0);
  assert.match(await size(page), /^field 0 mT/);
  const before = await tip(page);
  assert.ok(await dragBy(page, 20, -25) < 1, 'the arrow does not follow the pointer');
  const [x, z] = [await command(page, 0), await command(page, 1)], shown = await tipText(page);
  assert.ok(x > 0.1 && z > 0.1, `dragged to the right and up, the field is ${x}, ${z} mT`);
  assert.ok(distance(await tip(page), before) > 0.1, 'the robot does not follow');
  assert.ok(Math.abs(Number((await size(page)).split(' ')[1]) - Math.hypot(x, z)) < 0.006, await size(page));
  await page.locator('#undo').click();
  assert.deepEqual([await command(page, 0), await command(page, 1)], [0, 0]);
  for (const [a, value] of [x, z].entries()) await page.locator('.typed input').nth(a).fill(String(value));
  await page.keyboard.press('Enter');
  assert.deepEqual(await tipText(page), shown, 'sliders give another position');
  await dragBy(page, 0, -700);
  assert.equal(await command(page, 1), 1.2);
}

async function checkLooks(browser, url) {
  for (const [width, scheme] of [[1280, 'light'], [1280, 'dark'], [390, 'dark']]) {
    const {page, watch, context} = await open(browser, url, {width, height: width < 600 ? 844 : 720, scheme});
    await frames(page, 3);
    assert.deepEqual(await violations(page), []);
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= width);
    await page.screenshot({path: out(`field_${width}_${scheme}.png`)});
    await page.getByLabel('magnetic field', {exact: true}).uncheck();
    await frames(page);
    assert.ok(await page.locator('#labels .field').isHidden());
    assert.deepEqual([...watch.errors, ...watch.requests], []);
    await context.close();
  }
}

/** Without map and program the arrow shows, and is not dragged. */
async function checkWithoutMap(browser) {
  await softkin('fk', example(crawler), '--path', example(crawler, 'path.csv'), '--html', out('field_steps.html'));
  const {page, watch, context} = await open(browser, pathToFileURL(resolve(out('field_steps.html'))).href);
  await checkSteps(page);
  await page.locator('#step').fill('1');
  await dragBy(page, 20, 20);
  assert.match(await page.locator('#step-text').textContent(), /^2 of 5/);
  assert.deepEqual([await command(page, 0), await command(page, 1)], [0, 1.2]);
  assert.equal(await size(page), 'field 1.20 mT');
  assert.deepEqual(watch.errors, []);
  await context.close();
}

export async function fieldTests(browser, test) {
  const file = out('field.html');
  await softkin('fk', example(crawler), '--path', example(crawler, 'path.csv'), '--map', await mapOf(crawler), '--html',
                file);
  const url = pathToFileURL(resolve(file)).href, {page, watch, context} = await open(browser, url);
  await test('field: steps move the arrow', () => checkSteps(page));
  await test('field: dragging the arrow commands as sliders do', () => checkDrag(page));
  await test('field: no errors, no requests', () => assert.deepEqual([...watch.errors, ...watch.requests], []));
  await context.close();
  await test('field: accessible in both themes', () => checkLooks(browser, url));
  await test('field: without a map the arrow shows alone', () => checkWithoutMap(browser));
}

const answered = (page) => page.waitForFunction(() =>
  /^Computed: converged/.test(document.querySelector('#state').textContent), null);

async function checkLive(page) {
  await page.waitForFunction(() => /^You control/.test(document.querySelector('#live-words').textContent));
  assert.match(await size(page), /^field 0 mT: drag me$/);
  const before = await tip(page);
  await dragBy(page, 0, -30);
  await answered(page);
  const field = await command(page, 0), [step] = await forward(example(cantilever), ['field_mT'], [[field]]);
  assert.ok(field > 5, `the field is ${field} mT`);
  assert.ok(distance(await tip(page), before) > 3, 'the robot does not follow');
  assert.ok(distance(await tip(page), step.markers.tip) < 0.02, `softkin fk computes ${step.markers.tip}`);
  await page.screenshot({path: out('field_live.png')});
  assert.deepEqual(await violations(page), []);
}

export async function liveFieldTests(browser, test) {
  const server = await serve(example(cantilever), 0);
  const {page, watch} = await open(browser, server.url, {offline: false});
  await test('live: dragging the field bends the robot', () => checkLive(page));
  await test('live: no errors of the field', () => assert.deepEqual(watch.errors, []));
  await page.context().close();
  await server.stop();
}
