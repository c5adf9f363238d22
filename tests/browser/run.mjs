// Tests of the page in a browser:  node run.mjs SOFTKIN OUT_FOLDER files|live
// files: pages of one file; live: softkin view. Writes screenshots into the folder, to be looked at.
// SOFTKIN_CHROMIUM: the browser, default /usr/bin/chromium.
import {mkdirSync} from 'node:fs';
import {launch} from './browser.mjs';
import {estimateTests} from './estimate.mjs';
import {fieldTests, liveFieldTests} from './field.mjs';
import {liveTests} from './live.mjs';
import {reportTests} from './report.mjs';
import {outputTests} from './outputs.mjs';
import {liveShownTests, shownTests} from './shown.mjs';
import {stopAll} from './softkin.mjs';
import {timeTests} from './times.mjs';

mkdirSync(process.argv[3], {recursive: true});
const browser = await launch();
let failed = 0, passed = 0;

async function test(name, act) {
  const start = performance.now();
  try {
    await act();
    ++passed;
    console.log(`ok: ${name} (${((performance.now() - start) / 1000).toFixed(1)} s)`);
  } catch (error) {
    ++failed;
    console.log(`FAILED: ${name}\n${error.stack ?? error}`);
  }
}

try {
  if (process.argv[4] === 'files') {
    await reportTests(browser, test);
    await outputTests(browser, test);
    await shownTests(browser, test);
    await fieldTests(browser, test);
    await timeTests(browser, test);
  } else {
    await liveFieldTests(browser, test);
    await liveShownTests(browser, test);
    await estimateTests(browser, test);
    await liveTests(browser, test);
  }
} finally {
  await browser.close();
  stopAll();
}
console.log(`${passed} passed, ${failed} failed`);
process.exitCode = failed ? 1 : 0;
