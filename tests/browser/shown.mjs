// A page when it opens: the robot at the rest commands, its base visible in both themes, names that do not cover each
// other; and the message for a number that is refused.
import assert from 'node:assert/strict';
import {resolve} from 'node:path';
import {pathToFileURL} from 'node:url';
import {frames, open, tipText, violations} from './browser.mjs';
import {example, mapOf, out, serve, softkin} from './softkin.mjs';

const name = 'three_tendon_finger';
const text = (page, id) => page.locator(`#${id}`).textContent();

/** Returns the mean colours of squares of 5 pixels around points of the page. */
async function coloursAt(page, places) {
  const png = (await page.screenshot()).toString('base64');
  return page.evaluate(async ([data, all]) => {
    const image = new Image();
    image.src = `data:image/png;base64,${data}`;
    await image.decode();
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [image.width, image.height];
    const context = canvas.getContext('2d');
    context.drawImage(image, 0, 0);
    return all.map(([x, y]) => {
      const {data: bytes} = context.getImageData(x - 2, y - 2, 5, 5);
      return [0, 1, 2].map((c) => bytes.filter((_, i) => i % 4 === c).reduce((sum, b) => sum + b, 0) / 25);
    });
  }, [png, places]);
}

/** Returns the contrast of two colours as WCAG defines it, 1 to 21. */
function contrast(a, b) {
  const light = (rgb) => rgb.map((c) => c / 255).map((s) => s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4)
    .reduce((sum, c, k) => sum + [0.2126, 0.7152, 0.0722][k] * c, 0);
  const [low, high] = [light(a), light(b)].sort((x, y) => x - y);
  return (high + 0.05) / (low + 0.05);
}

async function checkBase(browser, url) {
  for (const scheme of ['light', 'dark']) {
    const {page, context} = await open(browser, url, {scheme});
    await page.getByLabel('grid', {exact: true}).uncheck();
    await page.getByLabel('transparent', {exact: true}).uncheck();
    await frames(page, 3);
    const [side, ground] = await coloursAt(page, [[265, 500], [60, 300]]);
    assert.ok(contrast(side, ground) > 2, `${scheme}: the base is ${side} on ${ground}`);
    await page.screenshot({path: out(`shown_base_${scheme}.png`)});
    await context.close();
  }
}

async function checkTyped(page) {
  const field = page.locator('.typed input').first(), before = await tipText(page);
  await field.fill('0.4');
  await page.keyboard.press('Enter');
  const message = page.locator('.slider .bad').first();
  assert.equal(await message.textContent(),
    'tendon1: 0.4 is outside its range, 0.5 to 1 × rest length. The command is unchanged.');
  assert.equal(await field.getAttribute('aria-invalid'), 'true');
  assert.deepEqual(await tipText(page), before);
  await page.screenshot({path: out('shown_typed.png')});
  assert.deepEqual(await violations(page), []);
  await field.fill('0.8');
  await page.keyboard.press('Enter');
  assert.equal(await message.textContent(), '');
  assert.equal(await field.getAttribute('aria-invalid'), 'false');
  assert.notDeepEqual(await tipText(page), before);
}

/** Checks a robot with three markers whose names would otherwise cover each other and the legend. */
async function checkLabels(browser, url) {
  for (const [width, height] of [[390, 844], [360, 640], [1280, 720]]) {
    const {page, context} = await open(browser, url, {width, height});
    for (const step of [0, 3, 6]) {
      await page.locator('#step').fill(String(step));
      await frames(page, 3);
      const boxes = await page.evaluate(() => ['#labels span', '#hint', '#colour-bar', '#state', '#grid-size']
        .flatMap((what) => [...document.querySelectorAll(what)])
        .filter((each) => getComputedStyle(each).visibility === 'visible' && each.getClientRects().length > 0)
        .map((each) => [each.textContent, each.getBoundingClientRect().toJSON()]));
      assert.ok(boxes.length >= 4, `${boxes.length} texts on the picture`);
      boxes.forEach(([a, one], i) => boxes.slice(0, i).forEach(([b, other]) => {
        const apart = one.right <= other.left + 1 || other.right <= one.left + 1 || one.bottom <= other.top + 1 ||
          other.bottom <= one.top + 1;
        assert.ok(apart, `${width}x${height}, step ${step}: '${a}' covers '${b}'`);
      }));
    }
    await page.screenshot({path: out(`shown_labels_${width}.png`)});
    await context.close();
  }
}

export async function shownTests(browser, test) {
  const map = await mapOf(name), file = out('shown.html'), url = pathToFileURL(resolve(file)).href;
  await softkin('fk', example(name), '--path', example(name, 'path.csv'), '--map', map, '--html', file);
  const {page, watch, context} = await open(browser, url);
  await test('shown: a page opens at the rest commands', async () => {
    assert.deepEqual(await tipText(page), ['120.00', '0.00', '25.00']);
    for (const a of [0, 1, 2]) assert.equal(await page.locator(`#actuator-${a}`).inputValue(), '1');
    assert.equal(await text(page, 'state'), 'Equilibrium at the rest commands, from the map');
  });
  await test('shown: a number outside its range is refused with a message', () => checkTyped(page));
  await test('shown: no errors, no requests', () => assert.deepEqual([...watch.errors, ...watch.requests], []));
  await context.close();
  await test('shown: the base is seen in both themes', () => checkBase(browser, url));
  const gripper = 'cable_gripper_two_materials', crowded = out('shown_labels.html');
  await softkin('fk', example(gripper, 'a.yaml'), '--path', example(gripper, 'path.csv'), '--html', crowded);
  await test('shown: names do not cover each other', () => checkLabels(browser, pathToFileURL(resolve(crowded)).href));
}

/** Checks that a gripped ball, which moves by contact only, cannot be dragged. */
export async function liveShownTests(browser, test) {
  const server = await serve(example('two_finger_gripper', 'ball.yaml'), 0);
  const {page, watch} = await open(browser, server.url, {offline: false});
  await test('live: a body is no marker to drag', async () => {
    await page.waitForFunction(() => /^You control/.test(document.querySelector('#live-words').textContent));
    await frames(page, 2);
    assert.equal(await page.locator('#labels span').first().textContent(), 'ball');
    assert.ok(await page.locator('#target-section').isHidden());
    assert.doesNotMatch(await text(page, 'hint'), /round marker/);
    await page.screenshot({path: out('shown_body.png')});
  });
  await test('live: no errors of bodies', () => assert.deepEqual(watch.errors, []));
  await page.context().close();
  await server.stop();
}
