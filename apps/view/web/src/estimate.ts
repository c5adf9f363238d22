import {digits, plain, withUnit} from './text';

// Estimates of softkin view from readings, as it sends them; lengths in mm, forces in N.

/** deviation: the standard deviation, in the unit; group: readings that are left out together, such as a marker. */
export interface ReadingColumn { name: string; group: string; axis: string; unit: string; deviation: number }
/** told: the actuators whose commands are estimated; fade_s: the time constant of fading, or 0: each reading is
    estimated alone. */
export interface EstimateDocument { columns: ReadingColumn[]; told: number[]; fade_s: number }

export interface EstimatedNumber { name: string; unit: string; value: number; deviation: number }
export interface EstimatedPlace {
  force: string; at_rest_mm: number[]; present_mm: number[]; covariance_mm2: number[][];
}
/** across_N, place_mm: half axes of the ellipses that contain, with a probability of 90 %, the tip of the arrow, across
    the arrow, and the point of application. */
export interface EstimatedForce {
  name: string; at_mm: number[]; force_N: number[]; deviation_N: number; across_N: number[][];
  place_mm: number[][] | null;
}
export interface EstimatedReading { column: string; read: number; computed: number; computed_deviation: number }
/** Only status and remark are present where the estimate has not converged. */
export interface Estimate {
  status: string; remark: string;
  numbers?: EstimatedNumber[]; places?: EstimatedPlace[]; chi_square?: number; freedoms?: number; misfit?: number;
  left_out?: string[]; words?: string[]; readings?: EstimatedReading[]; forces?: EstimatedForce[];
}

const minus = (text: string): string => text.replaceAll('-', '−');

/** Formats a value with its deviation of two digits, both with the same number of decimals. */
export function plusMinus(value: number, deviation: number, unit: string): string {
  if (!(deviation > 1e-9)) return withUnit(digits(value), unit);
  const decimals = Math.min(Math.max(1 - Math.floor(Math.log10(deviation)), 0), 9);
  return withUnit(`${minus(value.toFixed(decimals))} ± ${deviation.toFixed(decimals)}`, unit);
}

/** Returns half the opening angle of the drawn cone, where it is widest [degrees]; 0 where there is no cone. */
export function halfOpening({force_N: force, across_N: across}: EstimatedForce): number {
  const widest = Math.hypot(...across[0]);
  return widest > 0 ? Math.atan2(widest, Math.hypot(...force)) * 180 / Math.PI : 0;
}

/** Formats the point of application of a force in the reference shape. */
export function placeText({at_rest_mm: at, covariance_mm2: covariance}: EstimatedPlace): string {
  const axes = at.map((value, k) => `${'xyz'[k]} ${plusMinus(value, Math.sqrt(Math.max(0, covariance[k][k])), '')}`);
  return `${axes.join(', ')} mm`;
}

/** Formats the magnitude of a force and the uncertainty of its direction. */
export function forceText(force: EstimatedForce): string {
  const size = Math.hypot(...force.force_N), opening = halfOpening(force);
  const direction = opening > 0 ? `; its direction within ${digits(opening, 2)}° (90 %)` : '';
  return `${plain(force.name)}: ${plusMinus(size, force.deviation_N, 'N')}${direction}`;
}

/** Describes how well readings and model agree. */
export function fitText({chi_square: chi, freedoms, misfit}: Estimate): string {
  if (chi === undefined || freedoms === undefined || misfit === undefined) return '';
  const fits = misfit < 3 ? 'the readings fit the model' : 'the readings do not fit the model';
  return `Chi-square ${digits(chi, 3)} for ${digits(freedoms, 3)} freedoms: ${fits}.`;
}
