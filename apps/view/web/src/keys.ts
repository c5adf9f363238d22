import type {RobotScene} from './scene';
import {byId} from './text';

export interface Actions { undo(): void; reset(): void; play(): void; picture(): void }

/** Handles keys: arrows, plus and minus turn and zoom while the picture has the focus; Ctrl+Z, space, R and S work
    anywhere. */
export function listenToKeys(scene: RobotScene, actions: Actions): void {
  byId('canvas').addEventListener('keydown', (event) => {
    const turns: Record<string, [number, number, number]> = {
      ArrowLeft: [-0.1, 0, 1], ArrowRight: [0.1, 0, 1], ArrowUp: [0, 0.1, 1], ArrowDown: [0, -0.1, 1],
      '+': [0, 0, 1.1], '=': [0, 0, 1.1], '-': [0, 0, 1 / 1.1],
    };
    const turn = turns[event.key];
    if (!turn) return;
    event.preventDefault();
    scene.turn(...turn);
  });
  window.addEventListener('keydown', (event) => {
    const {target} = event, key = event.key.toLowerCase(), held = event.ctrlKey || event.metaKey;
    const typing = target instanceof HTMLElement && /^(INPUT|SELECT|BUTTON|TEXTAREA)$/.test(target.tagName);
    const number = target instanceof HTMLInputElement && target.type === 'number';
    if (held && key === 'z' && !number) {
      event.preventDefault();
      actions.undo();
    }
    if (typing || held || event.altKey) return;
    if (key === ' ') {
      event.preventDefault();
      actions.play();
    } else if (key === 'r') actions.reset();
    else if (key === 's') actions.picture();
  });
}
