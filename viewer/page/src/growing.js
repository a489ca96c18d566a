// Geometry whose arrays grow: what is new is appended and sent to the graphics card alone.
import {
  BufferAttribute, BufferGeometry, InstancedInterleavedBuffer, InterleavedBufferAttribute,
} from 'three';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';

// Wide lines, each from a start to an end (six numbers).
export class GrowingSegments extends LineSegmentsGeometry {
  constructor() {
    super();
    this.count = 0;
    this.boundingSphere = null;
    this.reserve(1024);
  }

  reserve(count) {
    const array = new Float32Array(count * 6);
    if (this.buffer) array.set(this.buffer.array.subarray(0, this.count * 6));
    this.buffer = new InstancedInterleavedBuffer(array, 6, 1);
    this.setAttribute('instanceStart', new InterleavedBufferAttribute(this.buffer, 3, 0));
    this.setAttribute('instanceEnd', new InterleavedBufferAttribute(this.buffer, 3, 3));
    this.instanceCount = this.count;
    // A replaced attribute counts only once the old one is let go of.
    this.dispose();
  }

  append(a, b) {
    if ((this.count + 1) * 6 > this.buffer.array.length) this.reserve(this.count * 2);
    this.buffer.array.set(a, this.count * 6);
    this.buffer.array.set(b, this.count * 6 + 3);
    this.buffer.addUpdateRange(this.count * 6, 6);
    ++this.count;
  }

  commit() {
    this.buffer.needsUpdate = true;
    this.instanceCount = this.count;
  }

  clear() {
    this.count = 0;
    this.instanceCount = 0;
  }
}

// Points with an id each, which may move and go.
export class NumberedPoints extends BufferGeometry {
  constructor() {
    super();
    this.slots = new Map();
    this.ids = [];
    this.reserve(4096);
  }

  reserve(count) {
    const positions = new Float32Array(count * 3);
    const colours = new Float32Array(count * 3);
    if (this.attributes.position) {
      positions.set(this.attributes.position.array);
      colours.set(this.attributes.color.array);
      this.dispose();
    }
    this.setAttribute('position', new BufferAttribute(positions, 3));
    this.setAttribute('color', new BufferAttribute(colours, 3));
  }

  set(id, position, colour) {
    let slot = this.slots.get(id);
    if (slot === undefined) {
      slot = this.ids.length;
      if ((slot + 1) * 3 > this.attributes.position.array.length) this.reserve(slot * 2);
      this.slots.set(id, slot);
      this.ids.push(id);
    }
    this.attributes.position.array.set(position, slot * 3);
    this.attributes.color.array.set(colour, slot * 3);
  }

  remove(id) {
    const slot = this.slots.get(id);
    if (slot === undefined) return;
    const last = this.ids.length - 1;
    for (const { array } of [this.attributes.position, this.attributes.color]) {
      array.copyWithin(slot * 3, last * 3, last * 3 + 3);
    }
    this.ids[slot] = this.ids[last];
    this.slots.set(this.ids[slot], slot);
    this.ids.pop();
    this.slots.delete(id);
  }

  clear() {
    this.slots.clear();
    this.ids.length = 0;
  }

  commit() {
    this.attributes.position.needsUpdate = true;
    this.attributes.color.needsUpdate = true;
    this.setDrawRange(0, this.ids.length);
  }
}
