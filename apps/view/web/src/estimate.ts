import {digits, plain, withUnit} from './text';

// What softkin view tells from readings, as it says it; lengths in mm, forces in N.

/** deviation: standard, in the unit; group: what is left out together, such as a marker. */
export interface ReadingColumn { name: string; group: string; axis: string; unit: string; deviation: number }
/** told: actuators whose commands are told; fade_s: 0, each reading tells by itself. */
export interface EstimateDocument { columns: ReadingColumn[]; told: number[]; fade_s: number }

export interface ToldNumber { name: string; unit: string; value: number; deviation: number }
export interface ToldPlace { force: string; at_rest_mm: number[]; present_mm: number[]; covariance_mm2: number[][] }
/** across_N, place_mm: half axes of what holds the tip of the arrow, across it, and its place with 90 %. */
export interface ToldForce {
  name: string; at_mm: number[]; force_N: number[]; deviation_N: number; across_N: number[][];
  place_mm: number[][] | null;
}
export interface ToldReading { column: string; read: number; computed: number; computed_deviation: number }
/** Without numbers where it is not converged. */
export interface Estimate {
  status: string; remark: string;
  numbers?: ToldNumber[]; places?: ToldPlace[]; chi_square?: number; freedoms?: number; misfit?: number;
  left_out?: string[]; words?: string[]; readings?: ToldReading[]; forces?: ToldForce[];
}

const minus = (text: string): string => text.replaceAll('-', '−');

/** As many decimals as the deviation has to two digits. */
export function plusMinus(value: number, deviation: number, unit: string): string {
  if (!(deviation > 1e-9)) return withUnit(digits(value), unit);
  const decimals = Math.min(Math.max(1 - Math.floor(Math.log10(deviation)), 0), 9);
  return withUnit(`${minus(value.toFixed(decimals))} ± ${deviation.toFixed(decimals)}`, unit);
}

/** Half the opening of the cone that is drawn, where that is widest [degrees]; 0: there is none. */
export function halfOpening({force_N: force, across_N: across}: ToldForce): number {
  const widest = Math.hypot(...across[0]);
  return widest > 0 ? Math.atan2(widest, Math.hypot(...force)) * 180 / Math.PI : 0;
}

/** Where a force acts at rest, along each axis. */
export function placeText({at_rest_mm: at, covariance_mm2: covariance}: ToldPlace): string {
  const axes = at.map((value, k) => `${'xyz'[k]} ${plusMinus(value, Math.sqrt(Math.max(0, covariance[k][k])), '')}`);
  return `${axes.join(', ')} mm`;
}

/** How large it is and whereto, in words. */
export function forceText(force: ToldForce): string {
  const size = Math.hypot(...force.force_N), opening = halfOpening(force);
  const way = opening > 0 ? `; its direction within ${digits(opening, 2)}° (90 %)` : '';
  return `${plain(force.name)}: ${plusMinus(size, force.deviation_N, 'N')}${way}`;
}

/** How well readings and model agree. */
export function fitText({chi_square: chi, freedoms, misfit}: Estimate): string {
  if (chi === undefined || freedoms === undefined || misfit === undefined) return '';
  const fits = misfit < 3 ? 'the readings fit the model' : 'the readings do not fit the model';
  return `Chi-square ${digits(chi, 3)} for ${digits(freedoms, 3)} freedoms: ${fits}.`;
}
