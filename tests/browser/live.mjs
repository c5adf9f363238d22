// Live mode (softkin view): windows, control, and shapes equal to those of softkin fk.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {drag, dropFile, frames, moveSlider, open, patient, tip, tipOnScreen, tipText, violations} from './browser.mjs';
import {example, forward, mapOf, out, serve} from './softkin.mjs';

const name = 'three_tendon_finger', actuators = ['tendon1', 'tendon2', 'tendon3'];
const distance = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));
const until = (page, id, pattern, timeout = patient(60000)) => page.waitForFunction(([of, text]) =>
  new RegExp(text).test(document.getElementById(of).textContent), [id, pattern.source], {timeout});
const off = (page) => page.locator('#actuator-0').isDisabled();

/** Waits until softkin has answered the last request. */
const answered = (page) => until(page, 'state', /^Computed: converged/);

async function checkSliders(page) {
  const rows = [[0.8, 1, 1], [0.8, 0.75, 0.9], [1, 0.7, 0.65]], solved = await forward(example(name), actuators, rows);
  for (const [r, row] of rows.entries()) {
    for (const [a, value] of row.entries()) await moveSlider(page, a, value);
    await answered(page);
    const digits = solved[r].markers.tip.map((x) => (Math.abs(x) < 0.005 ? 0 : x).toFixed(2).replace('-', '−'));
    assert.ok(distance(await tip(page), solved[r].markers.tip) < 0.009,
              `${await tipText(page)} at ${row}, not ${digits}`);
  }
  const {latencies, frames: count} = await page.evaluate(() =>
    ({latencies: window.softkinPage.latencies, frames: window.softkinPage.frames}));
  assert.ok(latencies.length >= rows.length && count >= rows.length);
  const sorted = latencies.slice().sort((a, b) => a - b).map(Math.round);
  console.log(`live: ${sorted.length} latencies: median ${sorted[sorted.length >> 1]} ms, maximum ${sorted.at(-1)} ms`);
}

async function checkTarget(page) {
  const before = await tip(page), at = await tipOnScreen(page);
  await drag(page, at, {x: at.x - 15, y: at.y + 8});
  await until(page, 'error', /^(Reached|Out of reach|tip not reached)/);
  await answered(page);
  assert.ok(distance(await tip(page), before) > 1, 'the marker did not follow');
  await page.locator('#target input').nth(1).fill('60');
  await page.keyboard.press('Enter');
  await until(page, 'error', /not reached|Out of reach/);
  await page.locator('#undo').click();
  await answered(page);
  await page.locator('#reset').click();
  await answered(page);
  assert.equal(await page.locator('#actuator-0').inputValue(), '1');
}

async function checkFiles(page, withMap) {
  const rows = [[0.95, 1, 1], [0.9, 0.95, 1], [0.9, 0.9, 0.95]];
  await dropFile(page, 'three.csv', [actuators, ...rows].map((row) => row.join()).join('\n'));
  await until(page, 'step-text', /^3 of 3/);
  await answered(page);
  const last = (await forward(example(name), actuators, rows)).at(-1).markers.tip;
  assert.ok(distance(await tip(page), last) < 0.009, 'the last row gives another position');
  await dropFile(page, 'circle.csv', readFileSync(example(name, 'circle.csv'), 'utf8'));
  if (!withMap) {
    assert.match(await page.locator('#path .bad').textContent(), /Without a map .* need x_mm, y_mm and z_mm/);
    await dropFile(page, 'point.csv', 'x_mm,y_mm,z_mm\n110,0,45\n');
  }
  await until(page, 'path', /: [1-9]\d* of \d+ waypoints solved\. Farthest .*line \d+\), 0\.\d\d mm/);
  await page.getByText('Close the file').click();
  await answered(page);
}

async function checkHandOver(browser, page, url) {
  const {page: other, watch, context} = await open(browser, url, {scheme: 'dark', offline: false});
  await until(other, 'live-words', /Another window controls/);
  assert.ok(await off(other));
  assert.match(await other.locator('#explain-actuators').textContent(), /^Off: another window/);
  await moveSlider(page, 0, 0.85);
  await answered(page);
  await other.waitForFunction(() => document.querySelector('#actuator-0').value === '0.85');
  assert.deepEqual(await tipText(other), await tipText(page));
  await other.screenshot({path: out('live_watching.png')});
  assert.deepEqual(await violations(other), []);
  await other.locator('#control').click();
  await until(other, 'live-words', /^You control/);
  await until(page, 'live-words', /Another window controls/);
  assert.ok(await off(page) && !await off(other));
  await other.locator('#control').click();
  await until(page, 'live-words', /Nobody controls/);
  await page.locator('#control').click();
  await until(page, 'live-words', /^You control/);
  assert.deepEqual(watch.errors, []);
  await context.close();
  const stranger = await open(browser, url.split('#')[0], {offline: false});
  await until(stranger.page, 'live-words', /open the whole address/);
  assert.ok(await stranger.page.locator('#control').isHidden());
  assert.ok(await off(stranger.page));
  await stranger.context.close();
}

async function checkReconnection(page, server, more) {
  await server.stop();
  await until(page, 'live-words', /does not respond: trying again/);
  assert.ok(await off(page));
  await page.screenshot({path: out('live_away.png')});
  const again = await serve(example(name), server.port, ...more);
  // A new server has a new secret, so this window watches until its address is opened.
  await until(page, 'live-words', /controls the robot/);
  await page.goto('about:blank');
  await page.goto(again.url);
  await until(page, 'live-words', /^You control/);
  await moveSlider(page, 1, 0.9);
  await answered(page);
  return again;
}

async function allOf(browser, test, more, kind) {
  let server = await serve(example(name), 0, ...more);
  const {page, watch} = await open(browser, server.url, {offline: false});
  await test(`${kind}: the window with the secret has control`, () => until(page, 'live-words', /^You control/));
  await test(`${kind}: sliders give the positions of softkin fk`, () => checkSliders(page));
  await test(`${kind}: targets`, () => checkTarget(page));
  await test(`${kind}: files are played`, () => checkFiles(page, more.length > 0));
  await test(`${kind}: two windows and hand-over`, () => checkHandOver(browser, page, server.url));
  await test(`${kind}: accessible`, async () => {
    await frames(page, 3);
    await page.screenshot({path: out(`${kind.replaceAll(' ', '_')}.png`)});
    assert.deepEqual(await violations(page), []);
  });
  await test(`${kind}: it connects again`, async () => { server = await checkReconnection(page, server, more); });
  await test(`${kind}: no errors, no requests elsewhere`, () => {
    const origin = server.url.split('/#')[0].replace(/^http:/, '');
    assert.deepEqual([...watch.errors, ...watch.requests.filter((url) => !url.includes(origin))], []);
  });
  await page.context().close();
  await server.stop();
}

async function checkMapMadeMeanwhile(browser) {
  const server = await serve(example(name), 0, '--make-map');
  const {page, watch} = await open(browser, server.url, {offline: false});
  const whileOthersWork = patient(300000);  // maps are made at the lowest priority
  await until(page, 'origin', /A kinematic map is shown until .*: polynomials fitted to \d+ solved equilibria/, whileOthersWork);
  await until(page, 'live-words', /^You control/);
  await dropFile(page, 'circle.csv', readFileSync(example(name, 'circle.csv'), 'utf8'));  // which needs a map
  await until(page, 'path', /waypoints solved/);
  assert.deepEqual(watch.errors, []);
  await page.context().close();
  await server.stop();
}

export async function liveTests(browser, test) {
  await allOf(browser, test, [], 'live');
  await test('live: a map is made meanwhile', () => checkMapMadeMeanwhile(browser));
  await allOf(browser, test, ['--map', await mapOf(name)], 'live with a map');
}
