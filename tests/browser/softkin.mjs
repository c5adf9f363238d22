// Runs the program softkin.
import {execFile, spawn} from 'node:child_process';
import {existsSync} from 'node:fs';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';
import {promisify} from 'node:util';

const run = promisify(execFile);
const [program, folder] = process.argv.slice(2);
if (!program || !folder) {
  console.error('usage: node run.mjs SOFTKIN OUT_FOLDER files|live');
  process.exit(2);
}

export const out = (name) => join(folder, name);
// scripts/test_page.sh runs a copy of this folder
const source = process.env.SOFTKIN_SOURCE ?? join(dirname(fileURLToPath(import.meta.url)), '../..');
const examples = join(source, 'examples');
export const example = (name, file = `${name}.yaml`) => join(examples, name, file);

export async function softkin(...words) {
  const {stdout} = await run(program, words.map(String), {maxBuffer: 1 << 28});
  return stdout;
}

/** Returns the file of the map of an example, which is computed once and kept in the output folder. */
export async function mapOf(name) {
  const file = out(`${name}.skmap`);
  if (!existsSync(file)) await softkin('map', example(name), '-o', file, '--check', 10);
  return file;
}

/** Returns the steps in the report of fk for rows of commands. */
export async function forward(scene, names, rows, ...more) {
  const {writeFileSync} = await import('node:fs');
  writeFileSync(out('rows.csv'), [names, ...rows].map((row) => row.join()).join('\n') + '\n');
  return JSON.parse(await softkin('fk', scene, '--path', out('rows.csv'), '--json', ...more)).steps;
}

const serving = new Set();
/** Stops the servers that failed tests left running, which would keep this program from ending. */
export const stopAll = () => serving.forEach((child) => child.kill('SIGKILL'));

/** Starts softkin view, which runs until stop(). port: 0: any free one; output: returns its printed text */
export async function serve(scene, port, ...more) {
  const child = spawn(program, ['view', scene, '--no-open', '--port', String(port), ...more],
                      {stdio: ['ignore', 'pipe', 'inherit']});
  serving.add(child);
  const ended = new Promise((done) => child.on('exit', (code) => {
    serving.delete(child);
    done(code);
  }));
  let text = '';
  const url = await new Promise((found, failed) => {
    child.stdout.on('data', (data) => {
      text += data;
      const match = /view: (http:\S+)/.exec(text);
      if (match) found(match[1]);
    });
    void ended.then((code) => failed(new Error(`softkin view ended with ${code}: ${text}`)));
  });
  return {url, port: Number(new URL(url).port), output: () => text, stop: () => {
    child.kill('SIGINT');
    return ended;
  }};
}
