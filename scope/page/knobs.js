// A knob for each key that can be changed; without control the same keys, which only show.
import {withUnit} from './axes.js';

const SECTIONS_OPEN = ['drive'];
const JUST_TURNED_MS = 1000;  // a value that comes meanwhile may be older than the turn

/** Returns the scene of meta as knobs that only show. */
function shownOnly(scene) {
  const values = {};
  for (const [section, keys] of Object.entries(scene?.scene ?? {})) {
    for (const [name, value] of section === 'materials' ? [] : Object.entries(keys)) {
      const key = `${section}.${name}`;
      values[key] = {value, ...scene.keys?.[key]};
    }
  }
  return values;
}

export class Knobs {
  /** @param set (key, value) asks for a change */
  constructor(place, set) {
    this.place = place;
    this.set = set;
    this.rows = new Map();
    this.there = false;
  }

  show(knobs, scene) {
    this.there = knobs?.there === true;
    const values = this.there ? knobs.values : shownOnly(scene);
    const kinds = Object.entries(values).map(([key, {kind}]) => `${key} ${kind}`).join();
    if (kinds !== this.kinds) {
      this.kinds = kinds;
      this.build(values);
    }
    for (const [key, knob] of Object.entries(values)) {
      this.rows.get(key)?.update(knob, this.there);
    }
  }

  /** Takes back keys that were not changed. */
  refuse(keys) {
    for (const key of keys) {
      this.rows.get(key)?.refuse();
    }
  }

  build(values) {
    this.rows.clear();
    this.place.replaceChildren();
    const sections = new Map();
    for (const [key, knob] of Object.entries(values)) {
      const [section] = key.split('.');
      if (!sections.has(section)) {
        const box = document.createElement('details');
        box.open = SECTIONS_OPEN.includes(section);
        const title = document.createElement('summary');
        title.textContent = section;
        box.append(title);
        this.place.append(box);
        sections.set(section, box);
      }
      const row = new Knob(key, knob, (value) => this.set(key, value));
      this.rows.set(key, row);
      sections.get(section).append(row.element);
    }
  }
}

class Knob {
  constructor(key, knob, set) {
    this.key = key;
    this.set = set;
    this.turnedAt = -Infinity;
    this.element = document.createElement('div');
    this.element.className = 'knob';
    const label = document.createElement('label');
    label.textContent = key.split('.').slice(1).join('.');
    label.title = knob.description ?? '';
    this.input = this.newInput(knob);
    this.input.id = `knob-${key}`;
    label.htmlFor = this.input.id;
    this.unit = document.createElement('span');
    this.unit.className = 'unit';
    this.unit.textContent = knob.unit ?? '';
    this.limits = document.createElement('span');
    this.limits.className = 'limits';
    this.limits.id = `limits-${key}`;
    this.input.setAttribute('aria-describedby', this.limits.id);
    this.element.append(label, this.input, this.unit);
    if (this.isNumber(knob) && typeof knob.value === 'number' && knob.value > 0 && knob.kind) {
      this.addSlider(knob);
    }
    this.element.append(this.limits);
  }

  isNumber(knob) { return knob.kind === 'number' || knob.kind === 'integer' || typeof knob.value === 'number'; }

  newInput(knob) {
    if (knob.kind === 'word' && knob.words?.length > 0) {
      const input = document.createElement('select');
      for (const word of knob.words) {
        input.append(new Option(word, word));
      }
      input.onchange = () => this.set(input.value);
      return input;
    }
    const input = document.createElement('input');
    if (knob.kind === 'flag' || typeof knob.value === 'boolean') {
      input.type = 'checkbox';
      input.onchange = () => this.set(input.checked);
    } else if (this.isNumber(knob)) {
      input.type = 'number';
      input.step = knob.kind === 'integer' ? '1' : 'any';
      input.onchange = () => { if (input.value !== '') { this.set(Number(input.value)); } };
    } else {
      input.type = 'text';
      input.onchange = () => this.set(input.value);
    }
    return input;
  }

  /** A quarter to four times the value, and back to the middle. */
  addSlider(knob) {
    const slider = document.createElement('input');
    slider.type = 'range';
    slider.min = '-2';
    slider.max = '2';
    slider.step = '0.02';
    slider.value = '0';
    slider.setAttribute('aria-label', `${this.key}, from a quarter to four times its value`);
    const value = () => {
      const turned = Number((this.value * 2 ** Number(slider.value)).toPrecision(4));
      const inside = Math.min(Math.max(turned, this.knob.minimum ?? -Infinity), this.knob.maximum ?? Infinity);
      return knob.kind === 'integer' ? Math.round(inside) : inside;
    };
    slider.oninput = () => { this.input.value = value(); this.set(value()); };
    const letGo = () => { this.turning = false; slider.value = '0'; };
    slider.onchange = () => {
      this.value = value();  // the next turn begins there, whether it is known or not
      this.turnedAt = performance.now();
      this.set(this.value);
      letGo();
    };
    slider.onpointerdown = () => { this.turning = true; };
    slider.onpointerup = () => setTimeout(letGo);  // a change event comes first if it was moved
    slider.onpointercancel = letGo;
    slider.onblur = letGo;
    this.slider = slider;
    this.element.append(slider);
  }

  showValue() {
    if (this.input.type === 'checkbox') {
      this.input.checked = this.knob.value === true;
    } else {
      this.input.value = this.knob.value ?? '';
    }
  }

  /** A change was refused: shows the present value, unless the user types there. */
  refuse() {
    this.value = this.knob.value;
    if (document.activeElement === this.input && ['number', 'text'].includes(this.input.type)) {
      this.input.onblur = () => { this.input.onblur = null; this.showValue(); };
    } else {
      this.showValue();
    }
  }

  update(knob, there) {
    this.knob = knob;
    this.input.disabled = !there;
    if (this.slider) {
      this.slider.disabled = !there;
    }
    if (!this.turning && performance.now() - this.turnedAt > JUST_TURNED_MS) {
      this.value = knob.value;
      if (document.activeElement !== this.input) {
        this.showValue();
      }
    }
    const {minimum, maximum} = knob;
    const unit = knob.unit ?? '';
    this.limits.textContent = minimum !== undefined || maximum !== undefined
      ? `${withUnit(knob.value, unit)}; from ${withUnit(minimum ?? -Infinity, unit)} to ${withUnit(maximum ?? Infinity, unit)}`
      : knob.allowed ?? '';
  }
}
