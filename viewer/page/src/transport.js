// Which frame is shown: the newest, or one that is held. Pausing holds the page, and the playback
// too where that can wait.

export class Transport extends EventTarget {
  constructor(model) {
    super();
    this.model = model;
    this.held = null;  // row; null: the newest
    for (const id of ['pause', 'back', 'step', 'scrub', 'live', 'place']) {
      this[`${id}Element`] = document.getElementById(id);
    }
    this.pauseElement.onclick = () => this.toggle();
    this.backElement.onclick = () => this.move(-1);
    this.stepElement.onclick = () => this.move(1);
    this.liveElement.onclick = () => this.release();
    this.scrubElement.oninput = () => this.hold(Number(this.scrubElement.value));
    addEventListener('keydown', (event) => this.key(event));
    model.addEventListener('frames', ({ detail }) => this.take(detail.reset));
    model.addEventListener('update', () => this.show());
  }

  get last() {
    return this.model.rows.count - 1;
  }

  get row() {
    return this.held === null ? this.last : Math.min(this.held, this.last);
  }

  get stopped() {
    return this.held !== null || this.model.playback.paused;
  }

  take(reset) {
    if (reset && this.held !== null && this.last < this.held) this.held = null;
  }

  hold(row) {
    this.held = Math.min(Math.max(0, row), Math.max(0, this.last));
    this.tell();
  }

  release() {
    this.held = null;
    this.tell();
  }

  toggle() {
    const { pausable, paused } = this.model.playback;
    if (this.stopped) {
      this.release();
      if (paused) this.model.command('go');
    } else {
      this.hold(this.last);
      if (pausable && !this.model.finished) this.model.command('pause');
    }
  }

  move(by) {
    const row = this.row;
    if (by > 0 && row >= this.last && this.model.playback.pausable && !this.model.finished) {
      this.release();  // a playback that takes single steps shows the newest
      this.model.command('step');
    } else {
      this.hold(row + by);
    }
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const inRange = event.target === this.scrubElement;
    const onCanvas = event.target.id === 'world-canvas';
    const onButton = event.target.closest?.('button, input[type=checkbox]');
    if (event.key === ' ' && !onButton) this.toggle();
    else if (event.key === 'End') this.release();
    else if (event.key === 'Home') this.hold(0);
    else if (event.key === 'ArrowLeft' && !inRange && !onCanvas) this.move(-1);
    else if (event.key === 'ArrowRight' && !inRange && !onCanvas) this.move(1);
    else return;
    event.preventDefault();
  }

  tell() {
    this.show();
    this.dispatchEvent(new Event('row'));
  }

  show() {
    const rows = this.model.rows;
    this.scrubElement.max = Math.max(0, this.last);
    this.scrubElement.value = Math.max(0, this.row);
    const words = this.stopped ? 'Go on' : 'Pause';
    if (this.pauseElement.textContent !== words) this.pauseElement.textContent = words;
    this.pauseElement.title = `${words} (space)`;
    this.liveElement.setAttribute('aria-pressed', String(this.held === null));
    if (this.last < 0) return;
    const total = this.model.info?.total;
    const seconds = rows.get(this.row, 1).toFixed(1);
    const text = `${rows.get(this.row, 0)}${total ? ` / ${total}` : ''} · ${seconds} s`;
    this.placeElement.textContent = text;
    this.scrubElement.setAttribute('aria-valuetext', `frame ${text}`);
  }
}
