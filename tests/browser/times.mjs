// Steps with times are played at their times.
import assert from 'node:assert/strict';
import {readFileSync, writeFileSync} from 'node:fs';
import {resolve} from 'node:path';
import {pathToFileURL} from 'node:url';
import {frames, open, patient, violations} from './browser.mjs';
import {example, out, softkin} from './softkin.mjs';

const name = 'three_tendon_finger';
const shown = (page) => page.locator('#step-text').textContent();
const speeds = (page) => page.locator('#speed option').allTextContents();

/** Opens the page that softkin fk or follow writes for these rows. */
async function pageOf(browser, command, rows, options) {
  const path = out(`${command}_times.csv`), html = out(`${command}_times.html`);
  writeFileSync(path, rows.join('\n') + '\n');
  if (command === 'follow') await softkin('follow', example(name), path, '-o', out('followed'), '--html', html);
  else await softkin('fk', example(name), '--path', path, '--html', html);
  return open(browser, pathToFileURL(resolve(html)).href, options);
}

/** Measures how long the page plays from the first step to the last [s]. */
async function played(page) {
  await page.locator('#step').fill('0');
  return page.evaluate(() => new Promise((done) => {
    const text = document.getElementById('step-text'), begin = performance.now();
    const seen = new MutationObserver(() => {
      if (!/^4 of 4/.test(text.textContent)) return;
      seen.disconnect();
      done((performance.now() - begin) / 1000);
    });
    seen.observe(text, {childList: true, characterData: true, subtree: true});
    document.getElementById('play').click();
  }));
}

async function checkSeconds(browser) {
  const {page, watch, context} = await pageOf(browser, 'fk',
    ['t_s,tendon1', '0,1', '0.25,0.95', '1.25,0.9', '1.3,0.85'], {scheme: 'dark'});
  assert.equal(await shown(page), '4 computed steps');
  await page.locator('#step').fill('3');
  assert.equal(await shown(page), '4 of 4, t = 1.3 s');
  await page.locator('#step').fill('2');
  assert.equal(await shown(page), '3 of 4, t = 1.25 s');
  assert.deepEqual(await speeds(page), ['0.25 ×', '1 ×', '4 ×']);
  assert.equal(await page.locator('#speed').inputValue(), '1');
  // the first step is shown already, so playing continues with the second
  const usual = await played(page);
  assert.ok(usual > 1 && usual < patient(2000) / 1000, `${usual} s`);
  await page.getByLabel('Speed').selectOption('4 ×');
  const faster = await played(page);
  assert.ok(faster > 0.25 && faster < 0.8 * usual, `${faster} s at 4 ×, ${usual} s at 1 ×`);
  assert.deepEqual(await violations(page), []);
  await page.screenshot({path: out('times_seconds.png')});
  assert.deepEqual([...watch.errors, ...watch.requests], []);
  await context.close();
}

async function checkHours(browser) {
  const {page, watch, context} = await pageOf(browser, 'follow',
    ['t_s,x_mm,z_mm', '0,76,74', '3600,77,74', '7200,78,74', '14400,79,74'], {width: 390, height: 844});
  await page.locator('#step').fill('3');
  assert.equal(await shown(page), '4 of 4, t = 14400 s');
  assert.deepEqual(await speeds(page), ['0.25 ×', '1 ×', '4 ×', '500 ×']);
  assert.equal(await page.locator('#speed').inputValue(), '500');
  await frames(page);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= 390);
  assert.deepEqual(await violations(page), []);
  await page.screenshot({path: out('times_hours.png')});
  assert.deepEqual([...watch.errors, ...watch.requests], []);
  await context.close();
}

async function checkNone(browser) {
  const {page, context} = await pageOf(browser, 'fk', ['tendon1', '1', '0.9'], {});
  await page.locator('#step').fill('1');
  assert.equal(await shown(page), '2 of 2');
  assert.ok(await page.locator('#speed').isHidden());
  await context.close();
}

/** Checks that the saved file is a video of the picture's size and of the duration of the steps. */
async function checkVideo(browser) {
  const {page, watch, context} = await pageOf(browser, 'fk', ['t_s,tendon1', '0,1', '0.5,0.9', '1.5,0.7'], {});
  await page.locator('#step').fill('2');
  const [download] = await Promise.all([page.waitForEvent('download'), page.locator('#record').click()]);
  assert.match(download.suggestedFilename(), /^three_tendon_finger\.(mp4|webm)$/);
  const file = out(download.suggestedFilename());
  await download.saveAs(file);
  assert.equal(await page.locator('#record').textContent(), 'Record');
  assert.equal(await shown(page), '3 of 3, t = 1.5 s');
  const bytes = readFileSync(file), type = file.endsWith('mp4') ? 'video/mp4' : 'video/webm';
  const size = await page.locator('#canvas').evaluate(({width, height}) => ({width, height}));
  const other = await context.newPage();  // the page itself may load nothing
  const seen = await other.evaluate(async ([data, kind]) => {
    const video = document.createElement('video');
    video.muted = true;
    video.src = `data:${kind};base64,${data}`;
    const paint = document.createElement('canvas').getContext('2d', {willReadFrequently: true});
    const sums = new Set();
    await new Promise((done, failed) => {
      video.onerror = () => failed(video.error);
      video.onended = done;
      video.ontimeupdate = () => {
        paint.drawImage(video, 0, 0, 300, 150);
        sums.add(paint.getImageData(0, 0, 300, 150).data.reduce((sum, x) => sum + x, 0));
      };
      void video.play();
    });
    return {width: video.videoWidth, height: video.videoHeight, end: video.currentTime, shapes: sums.size};
  }, [bytes.toString('base64'), type]);
  for (const side of ['width', 'height'])
    assert.ok(seen[side] === size[side] - size[side] % 2, `${side} ${seen[side]} of ${size[side]}`);
  assert.ok(seen.end > 1.5 && seen.end < patient(4000) / 1000, `${seen.end} s`);
  assert.ok(seen.shapes >= 2, 'the video shows one shape only');
  assert.deepEqual([...watch.errors, ...watch.requests], []);
  await context.close();
}

export async function timeTests(browser, test) {
  await test('times: steps show their times and are played at them', () => checkSeconds(browser));
  await test('times: a path of hours is played faster', () => checkHours(browser));
  await test('times: the played steps are saved as a video', () => checkVideo(browser));
  await test('times: steps without times have no speed', () => checkNone(browser));
}
