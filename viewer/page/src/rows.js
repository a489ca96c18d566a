// What is known of every frame: one row of numbers each, in the order of Scene::columns.

export const column = {
  index: 0, time: 1, localised: 2, state: 3, map: 4, position: 5, rotation: 8, features: 12,
  removed: 13, landmarks: 14, detections: 15, carried: 16, keyframe: 17, decode: 18, feature: 19,
  detection: 20, masks: 21, removal: 22, tracking: 23, frame: 24,
};
const width = 25;
const movedWidth = 9;  // index, map, pose
const most = 300_000;  // more than the server keeps

export class Rows {
  constructor() {
    this.clear();
  }

  clear() {
    this.data = new Float32Array(1024 * width);
    this.count = 0;
    this.thinned = 0;  // how often rows went, so that others know to begin anew
  }

  append(values) {
    const added = values.length / width;
    while ((this.count + added) * width > this.data.length) {
      const larger = new Float32Array(this.data.length * 2);
      larger.set(this.data);
      this.data = larger;
    }
    this.data.set(values, this.count * width);
    this.count += added;
    if (this.count > most) this.thin();
  }

  // Frames that lie elsewhere now.
  move(values) {
    for (let at = 0; at < values.length; at += movedWidth) {
      const row = this.rowOf(values[at]);
      if (this.get(row, column.index) !== values[at]) continue;  // thinned out here
      this.data[row * width + column.map] = values[at + 1];
      this.pose(row).set(values.subarray(at + 2, at + movedWidth));
    }
  }

  // Every second row of the older half goes.
  thin() {
    const half = Math.floor(this.count / 2);
    let kept = 0;
    for (let i = 0; i < this.count; ++i) {
      if (i < half && i % 2 === 1) continue;
      this.data.copyWithin(kept * width, i * width, (i + 1) * width);
      ++kept;
    }
    this.count = kept;
    ++this.thinned;
  }

  get(row, which) {
    return this.data[row * width + which];
  }

  // The last row whose frame is not after this one; 0 where all are.
  rowOf(index) {
    let low = 0;
    let high = this.count - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.get(middle, column.index) <= index) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  // World from camera: [x y z qx qy qz qw].
  pose(row) {
    const at = row * width + column.position;
    return this.data.subarray(at, at + 7);
  }
}
