// What the server said so far. Asks for what is new whenever there may be something, one question
// at a time: a slow page gets newer data, never a queue.
import { load } from './container.js';
import { Rows } from './rows.js';

export class Model extends EventTarget {
  constructor() {
    super();
    this.rows = new Rows();
    this.forget();
    this.busy = false;
    this.again = false;
  }

  forget() {
    this.run = '';
    this.newest = -1;
    this.path = 0;
    this.mapVersion = 0;
    this.messageCount = 0;
    this.info = null;
    this.playback = { pausable: false, paused: false };
    this.finished = false;
    this.rows.clear();
    this.keyframes = new Map();
    this.clouds = new Set();
    this.messages = [];
  }

  async pull() {
    this.again = true;
    if (this.busy) return;
    this.busy = true;
    try {
      while (this.again) {
        this.again = false;
        await this.pullOnce();
      }
    } finally {
      this.busy = false;
    }
  }

  async pullOnce() {
    const query = new URLSearchParams({
      run: this.run, frame: this.newest, path: this.path, map: this.mapVersion,
      message: this.messageCount,
    });
    const answer = await load(`/api/update?${query}`);
    this.apply(answer);
    if (answer.head.more) this.again = true;
  }

  apply(answer) {
    const head = answer.head;
    const begins = head.run !== this.run;
    if (begins) {
      this.forget();
      this.run = head.run;
      this.info = head;
      this.tell('begin');
    }
    this.finished = head.finished;
    this.hasTruth = head.truth;
    this.start = head.start;
    this.playback = head.playback;
    this.landmarkCount = head.landmarks;
    this.clouds = new Set(head.clouds);
    this.fused = head.fused;  // version of the run's dense map, null where it has none
    this.applyFrames(answer, begins);
    this.applyMap(answer, begins);
    if (head.messages.length > 0) {
      this.messages.push(...head.messages);
      this.messages.splice(0, Math.max(0, this.messages.length - 500));
      this.messageCount = this.messages.at(-1).number;
      this.tell('messages');
    }
    this.tell('update');
  }

  applyFrames(answer, begins) {
    const head = answer.head;
    this.path = head.path;
    if (head.path_reset) this.rows.clear();
    const moved = answer.section('moved', Float32Array);
    if (this.rows.count > 0) this.rows.move(moved);
    const values = answer.section('frames', Float32Array);
    this.rows.append(values);
    if (this.rows.count > 0) this.newest = this.rows.get(this.rows.count - 1, 0);
    const reset = head.path_reset || begins || moved.length > 0;
    if (values.length > 0 || reset) this.tell('frames', { reset });
  }

  applyMap(answer, begins) {
    const head = answer.head;
    if (head.map === this.mapVersion && !begins) return;
    if (head.map_reset) this.keyframes.clear();
    for (const keyframe of head.keyframes) this.keyframes.set(keyframe.id, keyframe);
    for (const id of head.gone_keyframes) this.keyframes.delete(id);
    this.mapVersion = head.map;
    this.tell('map', {
      reset: head.map_reset,
      ids: answer.section('landmark_ids', Int32Array),
      maps: answer.section('landmark_maps', Int32Array),
      positions: answer.section('landmark_positions', Float32Array),
      gone: answer.section('gone_landmarks', Int32Array),
    });
  }

  tell(type, detail = null) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }

  // "pause", "go" or "step".
  async command(what) {
    await fetch('/api/playback', {
      method: 'POST',
      headers: { 'Content-Type': 'application/json' },
      body: JSON.stringify({ do: what }),
    });
    await this.pull();
  }
}
