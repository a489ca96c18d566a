// The camera's path, the true one, and where the camera is now.
import {
  BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments, Quaternion, Vector3,
} from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { GrowingSegments } from './growing.js';
import { column } from './rows.js';
import { colour, onSchemeChange } from './theme.js';

// Ends of the edges of a camera's pyramid, `size` metres deep, in its own frame.
export function frustum(camera, size) {
  const corner = (u, v) =>
    [((u - camera.cx) / camera.fx) * size, ((v - camera.cy) / camera.fy) * size, size];
  const tip = [0, 0, 0];
  const a = corner(0, 0);
  const b = corner(camera.width, 0);
  const c = corner(camera.width, camera.height);
  const d = corner(0, camera.height);
  return [tip, a, tip, b, tip, c, tip, d, a, b, b, c, c, d, d, a];
}

function wideLine(stage, width) {
  const line = new LineSegments2(new GrowingSegments(), new LineMaterial({ linewidth: width }));
  line.frustumCulled = false;
  stage.root.add(line);
  stage.resizers.push((w, h) => line.material.resolution.set(w, h));
  return line;
}

export class Paths {
  constructor(stage, model) {
    this.stage = stage;
    this.model = model;
    this.path = wideLine(stage, 3);
    this.truth = wideLine(stage, 2);
    this.truth.renderOrder = -1;
    this.now = new LineSegments(new BufferGeometry(), new LineBasicMaterial());
    this.now.frustumCulled = false;
    this.now.visible = false;
    stage.root.add(this.now);
    this.segmentOfRow = [];  // how many segments end at or before a row
    this.drawn = 0;          // rows
    this.paint();
    onSchemeChange(() => this.paint());
  }

  paint() {
    this.path.material.color.set(colour('path'));
    this.truth.material.color.set(colour('truth'));
    this.now.material.color.set(colour('now'));
    this.stage.draw();
  }

  begin(camera) {
    const corners = frustum(camera, 0.18).flat();
    this.now.geometry.setAttribute('position', new BufferAttribute(new Float32Array(corners), 3));
    this.truth.geometry.clear();
    this.restart();
  }

  restart() {
    this.path.geometry.clear();
    this.segmentOfRow = [];
    this.drawn = 0;
    this.now.visible = false;
  }

  // Takes in the rows that are new.
  grow() {
    const rows = this.model.rows;
    if (this.thinned !== rows.thinned) {
      this.thinned = rows.thinned;
      this.restart();
    }
    for (; this.drawn < rows.count; ++this.drawn) {
      const row = this.drawn;
      const joined = row > 0 && rows.get(row, column.localised) && rows.get(row - 1, column.localised) &&
        rows.get(row, column.map) === rows.get(row - 1, column.map);
      if (joined) {
        this.path.geometry.append(rows.pose(row - 1).subarray(0, 3), rows.pose(row).subarray(0, 3));
      }
      this.segmentOfRow.push(this.path.geometry.count);
    }
    this.path.geometry.commit();
  }

  // Shows the path up to this row and the camera at it; its place on the page, or null where it is
  // lost.
  showRow(row) {
    const rows = this.model.rows;
    if (row < 0 || row >= rows.count) return null;
    this.path.geometry.instanceCount = this.segmentOfRow[row];
    const localised = rows.get(row, column.localised) === 1;
    if (localised) {
      const [x, y, z, qx, qy, qz, qw] = rows.pose(row);
      this.now.position.set(x, y, z);
      this.now.quaternion.copy(new Quaternion(qx, qy, qz, qw));
      this.now.visible = true;
    }
    this.stage.draw();
    return localised ? this.stage.place(...this.now.position) : null;
  }

  showTruth(points) {
    const geometry = this.truth.geometry;
    geometry.clear();
    for (let i = 3; i + 2 < points.length; i += 3) {
      geometry.append(points.subarray(i - 3, i), points.subarray(i, i + 3));
    }
    geometry.buffer.clearUpdateRanges();
    geometry.commit();
    this.stage.draw();
  }

  extend(box) {
    const rows = this.model.rows;
    for (let row = 0; row < rows.count; ++row) {
      if (rows.get(row, column.localised) !== 1) continue;
      box.expandByPoint(new Vector3(...this.stage.place(...rows.pose(row).subarray(0, 3))));
    }
  }
}
