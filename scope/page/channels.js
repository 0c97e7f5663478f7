// The choice of channels, "v_out", or "v_last[3]" of a stream with several: one has trigger and spectrum, others lie beside it.
import {BESIDE} from './axes.js';
import {protocol} from './protocol.js';

const [ALL, SEVERAL] = [' all', 'several'];  // choices of the list: the channels of a stream; those that were chosen one by one

export const streamOf = (channel) => channel.replace(/\[.*/, '');

/** Returns the names of a stream's channels. */
function channelsOf({name, channels}) {
  return channels === 1 ? [name] : Array.from({length: channels}, (_, i) => `${name}[${i + 1}]`);
}

export class ChannelChoice {
  /** @param parts {stream, channel, beside, list}: three selects, and the place of a button for each channel beside the first one
   * @param act is called after each choice, with a fault or "" */
  constructor(parts, act) {
    Object.assign(this, {parts, act, streams: [], offered: [], first: 'v_out', chosen: []});
    parts.stream.onchange = () => this.choose(channelsOf(this.streamNamed(parts.stream.value))[0], this.chosen);
    parts.channel.onchange = () => this.choose(parts.channel.value, this.chosen);
    parts.beside.onchange = () => this.add(parts.beside.value);
  }

  streamNamed(name) { return this.streams.find((stream) => stream.name === name); }

  /** The channels beside the first one, which may be chosen there, too. */
  get beside() { return this.chosen.filter((name) => name !== this.first); }

  /** All of them with their streams and units, the first one first. */
  all() {
    return [this.first, ...this.beside].map((name) => {
      const stream = streamOf(name);
      return {name, stream, unit: this.streamNamed(stream)?.unit ?? ''};
    });
  }

  /** Offers the channels of these streams. In place of a channel that is not there comes the first one of its stream, or of all.
   * @param unasked the channels beside the first one, unless the user has chosen */
  offer(streams, unasked) {
    this.streams = streams;
    const there = streams.flatMap(channelsOf);
    if (there.length === 0 || there.join() === this.offered.join()) {
      return;
    }
    this.offered = there;
    this.parts.stream.replaceChildren(...streams.map(({name}) => new Option(name, name)));
    this.parts.beside.replaceChildren(new Option('nothing', ''), Object.assign(new Option('', SEVERAL), {hidden: true}),
      ...streams.map((stream) => {
        const options = channelsOf(stream).map((name) => new Option(name, name));
        if (options.length === 1) {
          return options[0];
        }
        const group = Object.assign(document.createElement('optgroup'), {label: stream.name});
        group.append(new Option(`${stream.name}: all ${options.length}`, stream.name + ALL), ...options);
        return group;
      }));
    const alike = there.find((name) => streamOf(name) === streamOf(this.first));
    this.choose(there.includes(this.first) ? this.first : alike ?? there[0], this.touched ? this.chosen : unasked);
  }

  /** Adds a choice of the list to the channels beside the first one; "" takes all away. */
  add(choice) {
    this.touched = true;
    const stream = choice.endsWith(ALL) ? this.streamNamed(choice.slice(0, -ALL.length)) : null;
    this.choose(this.first, choice === '' ? [] : [...this.chosen, ...stream ? channelsOf(stream) : [choice]]);
  }

  choose(first, beside) {
    this.first = first;
    this.chosen = this.offered.filter((name) => beside.includes(name));
    const found = this.beside;
    const kept = found.slice(0, protocol.most_beside);
    this.chosen = this.chosen.filter((name) => name === first || kept.includes(name));
    this.show();
    this.act(kept.length < found.length ? `beside it: found ${found.length} channels, allowed: ${kept.length}, the first of which are shown` : '');
  }

  show() {
    const {parts, first, chosen} = this;
    const stream = this.streamNamed(streamOf(first));
    parts.stream.value = stream.name;
    parts.channel.replaceChildren(...channelsOf(stream).map((name, i) => new Option(String(i + 1), name)));
    parts.channel.value = first;
    parts.channel.parentElement.hidden = stream.channels === 1;
    parts.beside.querySelector(`[value="${SEVERAL}"]`).label = `${chosen.length} channels`;
    parts.beside.value = chosen.length > 1 ? SEVERAL : chosen[0] ?? '';
    parts.list.replaceChildren(...chosen.length > 1 ? chosen.map((name, i) => this.button(name, chosen[i - 1])) : []);
  }

  /** A button that takes a channel away, in the colour of its trace. */
  button(name, before) {
    const follows = before !== undefined && streamOf(before) === streamOf(name);
    const button = document.createElement('button');
    button.textContent = `${follows ? name.slice(streamOf(name).length) : name} \u00d7`;
    button.title = `without ${name}`;
    button.setAttribute('aria-label', button.title);
    const place = this.beside.indexOf(name);
    button.style.color = place < 0 ? '' : `var(--${BESIDE[place % BESIDE.length]})`;
    button.onclick = () => this.choose(this.first, this.chosen.filter((other) => other !== name));
    return button;
  }
}
