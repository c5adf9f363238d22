// Measures the time from a moved slider to the drawn shape in a page of softkin view:
//   node latency.mjs SOFTKIN OUT_FOLDER SCENE [MAP [MOVES]]
// Each move waits for the exact shape of the previous one. Also measures pictures per second while the camera moves.
import {launch, open} from './browser.mjs';
import {serve} from './softkin.mjs';

const [scene, map, moveCount] = process.argv.slice(4);
const moves = Number(moveCount ?? 40);
const sorted = (list) => [...list].sort((a, b) => a - b);
const quantile = (list, fraction) => sorted(list)[Math.min(list.length - 1, Math.floor(fraction * list.length))];
const summary = (list) =>
  `median ${quantile(list, 0.5).toFixed(0)} ms, 95th percentile ${quantile(list, 0.95).toFixed(0)} ms`;

const server = await serve(scene, 0, ...(map ? ['--map', map] : []));
const browser = await launch();
try {
  const {page} = await open(browser, server.url, {offline: false});
  await page.waitForFunction(() => !document.querySelector('#actuator-0').disabled);
  const [low, high] = await page.locator('#actuator-0').evaluate((slider) => [Number(slider.min), Number(slider.max)]);
  const waits = [], drawn = [];
  for (let i = 0; i < moves; ++i) {
    const value = low + (high - low) * (0.1 + 0.01 * i);
    const [first, exact] = await page.evaluate(async (to) => {
      const slider = document.querySelector('#actuator-0'), count = window.softkinPage.latencies.length;
      const gl = document.querySelector('#canvas').getContext('webgl2');
      await new Promise((go) => setTimeout(go, 100 + 17 * Math.random()));  // at any moment between two pictures
      const start = performance.now();
      slider.value = String(to);
      slider.dispatchEvent(new Event('input', {bubbles: true}));
      const frame = () => new Promise(requestAnimationFrame);
      await frame();  // after the page's own callback, which has drawn
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));  // waits for the picture
      const once = performance.now() - start;
      while (window.softkinPage.latencies.length === count) await frame();
      slider.dispatchEvent(new Event('change', {bubbles: true}));
      return [once, performance.now() - start];
    }, value);
    drawn.push(first);
    waits.push(exact);
  }
  console.log(`slider to exact shape drawn: ${summary(waits)} (${moves} moves of 1 % of the range)`);
  if (map) console.log(`slider to the map's shape drawn: ${summary(drawn)}`);
  const turned = await page.evaluate(async () => {
    const canvas = document.querySelector('#canvas'), frame = () => new Promise(requestAnimationFrame);
    const start = performance.now();
    for (let i = 0; i < 30; ++i) {
      canvas.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowRight', bubbles: true}));
      await frame();
    }
    return 30 / (performance.now() - start) * 1000;
  });
  console.log(`pictures per second while the camera moves: ${turned.toFixed(1)}`);
} finally {
  await browser.close();
  await server.stop();
}
