// A knob for each key that can be changed; without control the same keys, which only show.
import {withUnit} from './axes.js';

const SECTIONS_OPEN = ['drive'];

/** Returns a list as the stream reads it, numbers with their unit: "[0.2 mm, 20 um]". */
function listText(list, unit, digits) {
  const text = (entry) => (Array.isArray(entry) ? listText(entry, unit, digits)
    : typeof entry === 'number' ? withUnit(entry, unit, digits) : entry);
  return `[${list.map(text).join(', ')}]`;
}

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
  /** @param set (key, value) asks for a change @param isPending (key) whether one has no answer yet */
  constructor(place, set, isPending) {
    this.place = place;
    this.set = set;
    this.isPending = isPending;
    this.rows = new Map();
    this.there = false;
  }

  show(knobs, scene) {
    this.there = knobs?.there === true;
    if (scene?.run !== this.run) {
      this.run = scene?.run;
      this.rows.forEach((row) => { row.changedIn = 0; });
    }
    const values = this.there ? knobs.values : shownOnly(scene);
    const kinds = Object.entries(values).map(([key, {kind}]) => `${key} ${kind}`).join();
    if (kinds !== this.kinds) {
      this.kinds = kinds;
      this.build(values);
    }
    for (const [key, knob] of Object.entries(values)) {
      const row = this.rows.get(key);
      row?.update(knob, this.there, knobs?.epoch);
      const needs = scene?.keys?.[key]?.needs;
      row?.show(row.needed || !needs || needs.words.includes(values[needs.key]?.value));
    }
  }

  /** Shows below each key why it was not changed, and the keys that the change needs. @param faults of the answer; one of a key that was not
   * turned is shown at all that were */
  refuse(keys, faults) {
    for (const {key} of faults) {
      this.rows.get(key)?.need();
    }
    const text = (fault) => fault.message ?? `${fault.key}: found ${fault.found}, allowed: ${fault.allowed}`;
    for (const key of keys) {
      const own = faults.filter((fault) => fault.key === key);
      const others = faults.filter((fault) => !keys.includes(fault.key));
      this.rows.get(key)?.refuse((own.length > 0 ? own : others).map(text).join(' '));
    }
  }

  /** These keys were changed: from this epoch on they have the new values. */
  accept(keys, epoch) {
    for (const key of keys) {
      this.rows.get(key)?.accept(epoch);
    }
  }

  /** Shows a text below these keys, and below no other one. */
  note(keys, text) {
    for (const [key, row] of this.rows) {
      row.say(row.noted, keys.includes(key) ? text : '');
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
      const row = new Knob(key, knob, (value) => this.set(key, value), () => this.isPending(key));
      this.rows.set(key, row);
      sections.get(section).append(row.element);
    }
  }
}

class Knob {
  constructor(key, knob, set, isPending) {
    this.key = key;
    this.set = set;
    this.isPending = isPending;
    this.changedIn = 0;  // epoch
    this.needed = false;  // by a change that was refused for want of it
    this.element = document.createElement('div');
    this.element.className = Array.isArray(knob.value) || knob.kind === 'list' ? 'knob list' : 'knob';
    const label = document.createElement('label');
    label.textContent = key.split('.').slice(1).join('.');
    label.title = knob.description ?? '';
    this.input = this.newInput(knob);
    this.input.id = `knob-${key}`;
    label.htmlFor = this.input.id;
    this.use = this.part('output', 'use');
    this.limits = this.part('span', 'limits');
    this.fault = this.part('span', 'fault');
    this.fault.setAttribute('aria-live', 'polite');
    this.input.setAttribute('aria-describedby', `${this.use.id} ${this.limits.id} ${this.fault.id}`);
    this.noted = this.part('span', 'noted');
    this.element.append(label, this.use, this.input, this.fault, this.noted);
    if (this.isNumber(knob) && typeof knob.value === 'number' && knob.value > 0 && knob.kind) {
      this.addSlider(knob);
    }
    this.element.append(this.limits);
  }

  part(tag, name) {
    const part = document.createElement(tag);
    part.className = name;
    part.id = `${name}-${this.key}`;
    return part;
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
    } else {
      Object.assign(input, {type: 'text', autocomplete: 'off', autocapitalize: 'off', spellcheck: false});
      input.onchange = () => this.setText(input.value.trim());
      input.oninput = () => input.removeAttribute('aria-invalid');
      input.onblur = () => this.takeValue();
      input.onkeydown = ({key}) => { if (key === 'Escape') { this.giveUp(); } };
    }
    return input;
  }

  /** A number is one, with or without its unit ("3 um"), which the stream reads; so is a list. An empty one is taken back. */
  setText(text) {
    if (text === this.valueText() || (text !== '' && Number(text) === this.knob.value)) {
      this.giveUp();
    } else if (text === '') {
      this.set(null);
    } else {
      this.set(this.isNumber(this.knob) && Number.isFinite(Number(text)) ? Number(text) : text);
    }
  }

  valueText() {
    if (Array.isArray(this.knob.value)) {
      const mostShown = 1000;
      return this.knob.value.length > mostShown ? `${this.knob.value.length} entries` : listText(this.knob.value, this.knob.unit ?? '', 15);
    }
    return typeof this.knob.value === 'number' ? withUnit(this.knob.value, this.knob.unit ?? '', 15) : this.knob.value ?? '';
  }

  /** The ends of the slider: a quarter of the value and four times it, within its bounds. */
  sliderEnds() { return [this.turned(-2), this.turned(2)]; }

  turned(octaves) {
    const turned = Number((this.value * 2 ** octaves).toPrecision(4));
    const inside = Math.min(Math.max(turned, this.knob.minimum ?? -Infinity), this.knob.maximum ?? Infinity);
    return this.knob.kind === 'integer' ? Math.round(inside) : inside;
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
    slider.setAttribute('aria-describedby', this.limits.id);
    const value = () => this.turned(Number(slider.value));
    slider.oninput = () => {
      this.input.value = withUnit(value(), knob.unit ?? '', 15);
      this.saySlider(value());
      this.set(value());
    };
    const letGo = () => { this.turning = false; this.takeValue(); slider.value = '0'; };
    slider.onchange = () => {
      this.value = value();  // the next turn begins there, whether it is known or not
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

  /** Back to the value in use, of which nothing was refused. */
  giveUp() {
    this.fault.textContent = '';
    this.showValue();
  }

  saySlider(number) { this.slider.setAttribute('aria-valuetext', withUnit(number, this.knob.unit ?? '')); }

  showValue() {
    if (this.input.type === 'checkbox') {
      this.input.checked = this.knob.value === true;
    } else {
      this.input.value = this.valueText();
    }
    this.input.removeAttribute('aria-invalid');
  }

  /** A change was refused: shows the reason. A text stays, marked as wrong, while the user is at it. */
  refuse(reason) {
    this.fault.textContent = reason;
    if (this.isTypedInto()) {
      this.input.setAttribute('aria-invalid', 'true');
    }
    this.takeValue();
  }

  accept(epoch) {
    this.changedIn = epoch;
    this.fault.textContent = '';
    this.input.removeAttribute('aria-invalid');
  }

  /** @param epoch that the value belongs to */
  update(knob, there, epoch) {
    Object.assign(this, {knob, there, epoch});
    const turns = there && !knob.fixed;
    this.input.disabled = !turns;
    if (this.slider) {
      this.slider.disabled = !turns;
      this.slider.hidden = !(knob.value > 0) || knob.fixed === true;  // there is no quarter of nothing
    }
    this.say(this.use, `${this.text(knob.value)} in use`);
    this.takeValue();
  }

  /** Begins at the value in use, unless it is older than a change that this page has asked for. */
  takeValue() {
    const {knob} = this;
    if (!this.turning && !this.isPending() && !(this.epoch < this.changedIn)) {
      this.value = knob.value;
      if (this.slider) {
        this.saySlider(knob.value);
      }
      if (!this.isTypedInto()) {
        this.showValue();
      }
    }
    const text = (value) => this.text(value);
    const {minimum, maximum} = knob;
    const allowed = minimum !== undefined && knob.kind !== 'list' ? `allowed: ${text(minimum)} to ${text(maximum)}` : knob.allowed ?? knob.description ?? '';
    const slider = this.slider && !this.slider.hidden && this.there ? `slider: ${this.sliderEnds().map(text).join(' to ')}; ` : '';
    this.say(this.limits, knob.fixed ? 'fixed while the stream runs' : slider + allowed);
  }

  isTypedInto() { return document.activeElement === this.input && this.input.type === 'text'; }

  text(value) {
    const unit = this.knob.unit ?? '';
    return Array.isArray(value) ? listText(value, unit) : typeof value === 'number' ? withUnit(value, unit) : String(value ?? '\u2013');
  }

  /** A change needs this key, which had no effect so far. */
  need() {
    this.needed = true;
    this.show(true);
  }

  /** A key that has no effect in this scene is out of the way. */
  show(shown) {
    if (this.element.hidden === shown) {
      this.element.hidden = !shown;
    }
  }

  /** Sets a text that has changed, and leaves the page alone otherwise. */
  say(part, text) {
    if (part.textContent !== text) {
      part.textContent = text;
    }
  }
}
