// node exported_map.mjs MODULE COMMANDS.json: what an exported map answers, as JSON. Targets of ik are its own answers.
import {readFileSync} from 'node:fs';
import {pathToFileURL} from 'node:url';

const map = await import(pathToFileURL(process.argv[2]));
const middle = map.inputs.map(({low, high}) => low + 0.45 * (high - low));
// JSON has null for NaN
const answers = JSON.parse(readFileSync(process.argv[3], 'utf8')).map((row) => {
  const commands = row.map((x) => x ?? NaN);
  const found = map.fk(commands);
  if (!found) return {shape: map.shape ? map.shape(commands) : null};
  const target = found.outputs.slice(0, 3);
  return {...found, shape: map.shape ? Array.from(map.shape(commands)) : null,
          near: map.ik(map.markers[0], target, middle), far: map.ik(0, target.map((x) => 4 * x), middle)};
});
console.log(JSON.stringify({answers, check: map.check(), exported: Object.keys(map), inputs: map.inputs,
                            outputs: map.outputs, checked: map.checked, name: map.name}));
