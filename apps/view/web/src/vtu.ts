import {noRegion} from './document';

/** A surface with values at its vertices; region: the region number of each triangle. */
export interface Surface {
  positions: Float32Array; triangles: Uint32Array; region: Uint16Array; vectors: Record<string, Float32Array>;
  scalars: Record<string, Float32Array>;
}

const escaped = (text: string): string =>
  text.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('"', '&quot;');

/** Formats a number with nine digits, which determine a number of single precision. */
const short = (value: number): string => Number.isFinite(value) ? String(Number(value.toPrecision(9))) : 'nan';

function array(type: string, name: string, components: number, values: string[]): string {
  const kind = components > 1 ? ` NumberOfComponents="${components}"` : '';
  const head = `<DataArray type="${type}" Name="${escaped(name)}"${kind} format="ascii">`;
  return `${head}\n${values.join(' ')}\n</DataArray>\n`;
}

const reals = (name: string, components: number, values: Float32Array): string =>
  array('Float32', name, components, Array.from(values, short));

/** Formats a surface as a VTK UnstructuredGrid, for ParaView; vertices without triangle are left out. */
export function vtuOf({positions, triangles, region, vectors, scalars}: Surface): string {
  const used = [...new Set(triangles)].sort((a, b) => a - b), number = new Map(used.map((v, i) => [v, i]));
  const some = (values: Float32Array, size: number) =>
    Float32Array.from(used.flatMap((v) => [...values.subarray(size * v, size * v + size)]));
  const count = triangles.length / 3;
  const whole = (make: (i: number) => number) => Array.from({length: count}, (_, i) => String(make(i)));
  return '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian">\n' +
    `<UnstructuredGrid>\n<Piece NumberOfPoints="${used.length}" NumberOfCells="${count}">\n` +
    `<Points>\n${reals('Points', 3, some(positions, 3))}</Points>\n<Cells>\n` +
    array('Int32', 'connectivity', 1, Array.from(triangles, (v) => String(number.get(v)))) +
    array('Int32', 'offsets', 1, whole((i) => 3 * i + 3)) + array('UInt8', 'types', 1, whole(() => 5)) +
    '</Cells>\n<PointData>\n' +
    Object.entries(vectors).map(([name, values]) => reals(name, 3, some(values, 3))).join('') +
    Object.entries(scalars).map(([name, values]) => reals(name, 1, some(values, 1))).join('') +
    '</PointData>\n<CellData>\n' +
    array('Int32', 'region', 1, whole((i) => region[i] === noRegion ? -1 : region[i])) +
    '</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n';
}
