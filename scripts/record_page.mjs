// Moves a slider of a page and takes pictures: record_page.mjs PAGE.html FOLDER SLIDER FROM TO FRAMES (SLIDER from 0)
// writes FOLDER/frame_000.png and so on. gallery.py runs it next to browser.mjs of the page's tests.
import {frames, launch, moveSlider, open} from './browser.mjs';

const [page_file, folder, slider, from, to, count] = process.argv.slice(2);
const browser = await launch();
const {page} = await open(browser, `file://${page_file}`, {width: 1280, height: 720});
for (let i = 0; i < Number(count); ++i) {
  const part = 0.5 - 0.5 * Math.cos(Math.PI * i / (Number(count) - 1));
  await moveSlider(page, slider, (Number(from) + part * (Number(to) - Number(from))).toFixed(3));
  await frames(page, 3);
  await page.screenshot({path: `${folder}/frame_${String(i).padStart(3, '0')}.png`});
}
await browser.close();
