// Words and numbers: state, counts, facts, messages.
import { column } from './rows.js';

const byId = (id) => document.getElementById(id);

function pairs(list, entries) {
  list.replaceChildren(...entries.flatMap(([name, value]) => {
    const term = document.createElement('dt');
    const text = document.createElement('dd');
    term.textContent = name;
    text.textContent = value;
    return [term, text];
  }));
}

export class Status {
  constructor(model) {
    this.model = model;
    this.connection = 'connecting';
    model.addEventListener('begin', () => this.begin());
    model.addEventListener('messages', () => this.showMessages());
  }

  begin() {
    const { title, facts, kind } = this.model.info;
    byId('title').textContent = title;
    document.title = `${title} – dkp-slam`;
    document.body.dataset.kind = kind;
    pairs(byId('facts'), facts);
    byId('messages').replaceChildren();
  }

  // What the badge says, and how it looks.
  stateAt(row) {
    const { rows, finished, playback, info } = this.model;
    if (this.connection === 'refused') return ['too many pages are open', 'bad'];
    if (this.connection === 'lost') return [finished ? 'closed' : 'connection lost', 'bad'];
    if (info?.kind === 'map') return ['map', 'good'];
    if (row < 0) return [playback.paused ? 'paused' : 'waiting for frames', 'quiet'];
    const lost = rows.get(row, column.localised) !== 1;
    if (lost) return [rows.get(row, column.state) === 0 ? 'not started' : 'lost', 'bad'];
    if (finished) return ['finished', 'good'];
    if (playback.paused) return ['paused', 'quiet'];
    return ['tracking', 'good'];
  }

  show(row) {
    const [words, look] = this.stateAt(row);
    const badge = byId('state');
    if (badge.textContent !== words) badge.textContent = words;
    badge.dataset.look = look;
    const { rows, keyframes, landmarkCount } = this.model;
    const numbers = [['keyframes', keyframes.size], ['landmarks', landmarkCount ?? 0]];
    if (row >= 0) {
      const features = rows.get(row, column.features);
      const removed = rows.get(row, column.removed);
      numbers.unshift(['tracked', rows.get(row, column.landmarks)]);
      numbers.push(['removed', features > 0 ? `${Math.round((100 * removed) / features)}%` : '–']);
      numbers.push(['frame', `${rows.get(row, column.frame).toFixed(0)} ms`]);
    }
    pairs(byId('numbers'), numbers);
  }

  showMessages() {
    const list = byId('messages');
    const atEnd = list.scrollHeight - list.scrollTop - list.clientHeight < 30;
    list.replaceChildren(...this.model.messages.map(({ level, text, frame }) => {
      const item = document.createElement('li');
      item.dataset.level = level;
      const words = level === 'info' ? '' : `${level}: `;
      item.textContent = (frame >= 0 ? `${frame}  ` : '') + words + text;
      return item;
    }));
    if (atEnd) list.scrollTop = list.scrollHeight;
  }
}
