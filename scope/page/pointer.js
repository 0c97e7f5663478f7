// Mouse, fingers and keys on the waveform.

import {MARGIN} from './axes.js';

const CLICK_PIXELS = 4;

/** @param act {move(share), zoom(factor, share), zoomLevel(factor, share), home(), cursor(name, share), place(share), nudge(name, pixels), run(), hold(), single()} */
export function listen(canvas, act) {
  const width = () => canvas.clientWidth - MARGIN.left;
  const share = ({offsetX}) => Math.max(offsetX - MARGIN.left, 0) / width();
  const fingers = new Map();
  let travelled = 0;

  canvas.addEventListener('pointerdown', (event) => {
    if (event.button !== 0) {
      return;  // a menu's
    }
    fingers.set(event.pointerId, {x: event.offsetX});
    travelled = fingers.size === 1 ? 0 : Infinity;  // two fingers place no cursor
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener('pointermove', (event) => {
    const finger = fingers.get(event.pointerId);
    if (!finger) {
      return;
    }
    const by = event.offsetX - finger.x;
    if (fingers.size === 2) {
      const [other] = [...fingers.entries()].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
      const before = Math.abs(finger.x - other.x);
      const now = Math.abs(event.offsetX - other.x);
      if (before > 20 && now > 20) {
        act.zoom(before / now, share({offsetX: (event.offsetX + other.x) / 2}));
      }
    } else if (fingers.size === 1) {
      travelled += Math.abs(by);
      if (travelled > CLICK_PIXELS) {
        act.move(-by / width());
      }
    }
    finger.x = event.offsetX;
  });
  const release = (event) => {
    if (fingers.delete(event.pointerId) && event.type === 'pointerup' && travelled <= CLICK_PIXELS) {
      if (event.shiftKey) {
        act.cursor('B', share(event));
      } else {
        act.place(share(event));
      }
    }
  };
  canvas.addEventListener('pointerup', release);
  canvas.addEventListener('pointercancel', release);
  canvas.addEventListener('dblclick', () => act.home());
  canvas.addEventListener('wheel', (event) => {
    event.preventDefault();
    const factor = 1.2 ** Math.sign(event.deltaY || event.deltaX);
    if (event.shiftKey) {
      act.zoomLevel(factor, (event.offsetY - MARGIN.top) / (canvas.clientHeight - MARGIN.top - MARGIN.below));
    } else {
      act.zoom(factor, share(event));
    }
  }, {passive: false});

  let last = 'A';
  canvas.addEventListener('keydown', (event) => {
    const keys = {
      ArrowLeft: () => act.move(-0.1), ArrowRight: () => act.move(0.1),
      '+': () => act.zoom(0.7, 0.5), '=': () => act.zoom(0.7, 0.5), '-': () => act.zoom(1 / 0.7, 0.5),
      0: () => act.home(), Home: () => act.home(),
      a: () => { last = 'A'; act.cursor('A', 0.4); }, b: () => { last = 'B'; act.cursor('B', 0.6); },
      ',': () => act.nudge(last, -1), '.': () => act.nudge(last, 1), '<': () => act.nudge(last, -20), '>': () => act.nudge(last, 20),
      r: () => act.run(), s: () => act.single(), ' ': () => act.hold(),
    };
    if (!event.ctrlKey && !event.metaKey && !event.altKey && keys[event.key]) {
      event.preventDefault();
      keys[event.key]();
    }
  });
}
