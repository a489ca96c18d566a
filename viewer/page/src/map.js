// Keyframes with their frusta, which of them see the same, landmarks, and dense clouds.
import {
  BufferAttribute, BufferGeometry, Group, LineBasicMaterial, LineSegments, Points, PointsMaterial,
  Quaternion, Vector3,
} from 'three';
import { load } from './container.js';
import { NumberedPoints } from './growing.js';
import { frustum } from './paths.js';
import { colour, onSchemeChange } from './theme.js';

const heightRange = 3;  // metres, from one end of the colours to the other

function lines(stage, opacity) {
  const object = new LineSegments(
    new BufferGeometry(), new LineBasicMaterial({ transparent: true, opacity }));
  object.frustumCulled = false;
  stage.root.add(object);
  return object;
}

function setLines(object, numbers) {
  object.geometry.dispose();
  object.geometry = new BufferGeometry();
  object.geometry.setAttribute('position', new BufferAttribute(new Float32Array(numbers), 3));
}

function hexToRgb(hex) {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16) / 255);
}

export class MapLayers {
  constructor(stage, model) {
    this.stage = stage;
    this.model = model;
    this.covisibility = lines(stage, 0.35);
    this.keyframes = lines(stage, 0.9);
    this.points = new NumberedPoints();
    this.landmarks = new Points(
      this.points,
      new PointsMaterial({ size: 2, sizeAttenuation: false, vertexColors: true }));
    this.landmarks.frustumCulled = false;
    stage.root.add(this.landmarks);
    this.dense = new Group();
    this.dense.visible = false;
    stage.root.add(this.dense);
    this.clouds = new Map();
    this.positions = new Map();  // of landmarks, and their map: to colour them anew
    this.paint();
    onSchemeChange(() => this.paint());
  }

  paint() {
    this.keyframes.material.color.set(colour('keyframe'));
    this.covisibility.material.color.set(colour('covisibility'));
    this.low = hexToRgb(colour('landmark-low'));
    this.high = hexToRgb(colour('landmark-high'));
    for (const [id, { position }] of this.positions) this.points.set(id, position, this.tint(position));
    this.points.commit();
    this.stage.draw();
  }

  tint([, y]) {
    const share = Math.min(1, Math.max(0, 0.5 - y / heightRange));
    return this.low.map((low, i) => low + share * (this.high[i] - low));
  }

  begin() {
    this.points.clear();
    this.positions.clear();
    this.dense.clear();
    this.clouds.clear();
    this.fusedShown = '';
    this.camera = this.model.info.camera;
    this.shownMap = undefined;
  }

  apply({ reset, ids, maps, positions, gone }) {
    if (reset) {
      this.points.clear();
      this.positions.clear();
    }
    for (let i = 0; i < ids.length; ++i) {
      const position = positions.slice(3 * i, 3 * i + 3);
      this.positions.set(ids[i], { position, map: maps[i] });
      if (maps[i] === this.shownMap || this.shownMap === undefined) {
        this.points.set(ids[i], position, this.tint(position));
      } else {
        this.points.remove(ids[i]);
      }
    }
    for (const id of gone) {
      this.points.remove(id);
      this.positions.delete(id);
    }
    this.points.commit();
    this.drawKeyframes();
  }

  // Each map has a world frame of its own, so that one is shown at a time.
  showMap(map) {
    if (map === this.shownMap) return;
    this.shownMap = map;
    this.points.clear();
    for (const [id, point] of this.positions) {
      if (point.map === map) this.points.set(id, point.position, this.tint(point.position));
    }
    this.points.commit();
    this.drawKeyframes();
  }

  drawKeyframes() {
    const shape = frustum(this.camera, 0.07);
    const edges = [];
    const links = [];
    const at = new Vector3();
    const turn = new Quaternion();
    for (const keyframe of this.model.keyframes.values()) {
      if (this.shownMap !== undefined && keyframe.map !== this.shownMap) continue;
      const [x, y, z, qx, qy, qz, qw] = keyframe.pose;
      turn.set(qx, qy, qz, qw);
      for (const corner of shape) {
        at.set(...corner).applyQuaternion(turn);
        edges.push(at.x + x, at.y + y, at.z + z);
      }
      for (const id of keyframe.near) {
        const other = this.model.keyframes.get(id);
        if (!other || other.map !== keyframe.map) continue;
        if (other.id > keyframe.id && other.near.includes(keyframe.id)) continue;  // drawn there
        links.push(x, y, z, ...other.pose.slice(0, 3));
      }
    }
    setLines(this.keyframes, edges);
    setLines(this.covisibility, links);
    this.placeClouds();
    this.stage.draw();
  }

  // Fetches what is missing of the dense cloud: of the run's dense map where it has one, else of
  // the keyframes.
  async fillDense() {
    if (this.filling || !this.dense.visible) return;
    this.filling = true;
    try {
      await (this.model.fused === null ? this.fillKeyframes() : this.fillFused());
    } finally {
      this.filling = false;
    }
  }

  async fillFused() {
    const map = this.shownMap ?? 0;
    if (this.model.fused === 0 || this.fusedShown === `${map} ${this.model.fused}`) return;
    const answer = await load(`/api/fused?map=${map}`);
    if (!answer) return;
    this.fusedShown = `${map} ${answer.head.version}`;
    this.fused?.geometry.dispose();
    this.dense.clear();
    this.fused = this.cloudOf(answer.section('positions', Float32Array).slice(), answer);
    this.dense.add(this.fused);
    this.stage.draw();
  }

  // One keyframe at a time.
  async fillKeyframes() {
    for (const id of this.model.clouds) {
      if (this.clouds.has(id) || !this.dense.visible) continue;
      const answer = await load(`/api/cloud?keyframe=${id}`);
      if (answer) this.addCloud(id, answer);
    }
    for (const [id, points] of this.clouds) {
      if (this.model.clouds.has(id)) continue;
      this.dense.remove(points);
      points.geometry.dispose();
      this.clouds.delete(id);
    }
  }

  cloudOf(positions, answer) {
    const geometry = new BufferGeometry();
    geometry.setAttribute('position', new BufferAttribute(positions, 3));
    geometry.setAttribute(
      'color', new BufferAttribute(answer.section('colours', Uint8Array).slice(), 3, true));
    this.cloudMaterial ??= new PointsMaterial({ size: 0.018, vertexColors: true });
    const points = new Points(geometry, this.cloudMaterial);
    points.frustumCulled = false;
    return points;
  }

  addCloud(id, answer) {
    const millimetres = answer.section('positions', Int16Array);
    const points = this.cloudOf(Float32Array.from(millimetres, (mm) => mm / 1000), answer);
    this.clouds.set(id, points);
    this.dense.add(points);
    this.placeClouds();
    this.stage.draw();
  }

  placeClouds() {
    for (const [id, points] of this.clouds) {
      const keyframe = this.model.keyframes.get(id);
      points.visible = keyframe !== undefined && keyframe.map === (this.shownMap ?? keyframe.map);
      if (!points.visible) continue;
      const [x, y, z, qx, qy, qz, qw] = keyframe.pose;
      points.position.set(x, y, z);
      points.quaternion.set(qx, qy, qz, qw);
    }
  }

  // All but what lies farthest out, which a few wrong landmarks always do.
  extend(box) {
    for (const axis of ['x', 'y', 'z']) {
      const index = 'xyz'.indexOf(axis);
      const sign = index === 0 ? 1 : -1;
      const values = [];
      for (const slot of this.points.slots.values()) {
        values.push(sign * this.points.attributes.position.array[3 * slot + index]);
      }
      if (values.length === 0) return;
      values.sort((a, b) => a - b);
      const low = values[Math.floor(values.length * 0.03)];
      const high = values[Math.floor((values.length - 1) * 0.97)];
      box.min[axis] = Math.min(box.min[axis], low);
      box.max[axis] = Math.max(box.max[axis], high);
    }
  }
}
