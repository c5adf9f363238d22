// Opens pages in a browser without network, and provides actions and checks for the tests.
import axe from 'axe-core';
import {chromium} from 'playwright-core';

const chromiumFile = process.env.SOFTKIN_CHROMIUM ?? '/usr/bin/chromium';
const flags = ['--no-sandbox', '--disable-gpu', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
               '--disable-background-networking', '--disable-component-update', '--disable-sync', '--no-first-run'];

const slowness = (() => {
  const begin = performance.now();
  let root = 1;
  for (let i = 0; i < 4e6; ++i) root = 0.5 * (root + 2 / root) + 1e-9 * i;
  return Math.max(1, (performance.now() - begin) / 40);
})();

/** Scales a time limit of an idle machine of 2023 [ms] for slower or busy machines. */
export const patient = (milliseconds) => milliseconds * slowness;

/** Messages of browsers about a lost connection, after which live mode connects again. */
const expected = /WebSocket connection to|ERR_CONNECTION_REFUSED/;

/** Records errors and warnings of a page, and its requests for anything but its own address. */
export class Watch {
  errors = [];
  requests = [];

  constructor(page, own) {
    page.on('console', (message) => {
      if (/error|warning/.test(message.type()) && !/GPU stall|swiftshader/i.test(message.text()) &&
          !expected.test(message.text())) this.errors.push(message.text());
    });
    page.on('pageerror', (error) => this.errors.push(String(error.stack ?? error)));
    page.on('request', (request) => {
      const url = request.url();
      if (url.split('#')[0] !== own && !/^(blob|data):/.test(url)) this.requests.push(url);
    });
  }
}

export const launch = () => chromium.launch({executablePath: chromiumFile, args: flags});

/** Opens a page. offline: the page can load nothing but its own file. */
export async function open(browser, url, {width = 1280, height = 720, scheme = 'light', offline = true} = {}) {
  const context = await browser.newContext({viewport: {width, height}, colorScheme: scheme, hasTouch: width < 600,
                                            acceptDownloads: true, offline});
  const page = await context.newPage(), watch = new Watch(page, url.split('#')[0]);
  page.setDefaultTimeout(patient(60000));
  await page.goto(url);
  await page.waitForSelector('#table td');
  return {page, watch, context};
}

const number = (text) => Number(text.replace('−', '-'));

/** Returns the coordinates of the first marker [mm], as the page shows them. */
export async function tipText(page) {
  return (await page.locator('#table tbody tr').first().locator('td').allTextContents()).slice(1, 4);
}

export const tip = async (page) => (await tipText(page)).map(number);

export async function moveSlider(page, actuator, value) {
  // not by fill(), which refuses a value that the browser rounds to the slider's steps in another last digit
  await page.locator(`#actuator-${actuator}`).evaluate((slider, wanted) => {
    slider.value = wanted;
    for (const event of ['input', 'change']) slider.dispatchEvent(new Event(event, {bubbles: true}));
  }, String(value));
}

/** Waits until this number of frames has been drawn. */
export const frames = (page, count = 2) => page.evaluate((remaining) => new Promise((done) => {
  const next = () => remaining-- > 0 ? requestAnimationFrame(next) : done();
  next();
}), count);

/** Returns the position of the first marker on the screen; labels are placed when a frame is drawn. */
export async function tipOnScreen(page) {
  await frames(page);
  const box = await page.locator('#canvas').boundingBox();
  const [x, y] = (await page.locator('#labels span').first().getAttribute('data-at')).split(',').map(Number);
  return {x: box.x + x, y: box.y + y};
}

export async function drag(page, from, to) {
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(to.x, to.y, {steps: 5});
  await page.mouse.up();
  await frames(page);
}

export async function dropFile(page, name, text) {
  const data = await page.evaluateHandle(([file, content]) => {
    const made = new DataTransfer();
    made.items.add(new File([content], file, {type: 'text/csv'}));
    return made;
  }, [name, text]);
  await page.dispatchEvent('body', 'drop', {dataTransfer: data});
  await frames(page, 4);
}

/** Lists the elements that violate rules of accessibility (WCAG 2 AA and good practice). */
export async function violations(page) {
  const session = await page.context().newCDPSession(page);
  const {result} = await session.send('Runtime.evaluate', {
    expression: `${axe.source};axe.run().then((found) => JSON.stringify(found.violations.map((each) =>
      each.id + ' (' + each.impact + '): ' + each.nodes.map((node) => node.html.slice(0, 150)).join(' | '))))`,
    awaitPromise: true, returnByValue: true});
  return JSON.parse(result.value);
}
