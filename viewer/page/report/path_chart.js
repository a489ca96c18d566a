// Paths seen along one axis of the truth's frame, with one scale for both directions.
import { axis, Chart, gaps, seconds } from './frame.js';

// Estimates are shown this far beyond the true path, in units of its extent, and at least 5 cm.
const strayFactor = 0.75;
const strayLeast = 0.05;
const margin = 0.05;
const reach = 30;  // pixels from the cursor within which a pose is named

const planes = [['x', 'y'], ['x', 'z'], ['y', 'z']];

function extent(values, low, high) {
  return values.reduce(([a, b], v) => [Math.min(a, Math.max(v, low)), Math.max(b, Math.min(v, high))],
    [Infinity, -Infinity]);
}

// Of the truth; of equal ones the first.
function widestPlane(path) {
  const size = (which) => {
    const [low, high] = extent(path[which], -Infinity, Infinity);
    return high - low;
  };
  return planes.reduce((best, plane) => (
    size(plane[0]) * size(plane[1]) > 1.05 * size(best[0]) * size(best[1]) ? plane : best));
}

export class PathChart extends Chart {
  constructor(box, spec) {
    super(box, spec);
    this.zoomsBoth = true;
    this.breaks = spec.series.map(({ t }) => gaps(t));
    this.plane = widestPlane(spec.series[0]);
    const views = planes.map((plane) => this.button(plane.join('-'), `Seen with ${plane[0]} to the right, ${plane[1]} up`, (button) => {
      views.forEach((b) => b.setAttribute('aria-pressed', b === button));
      this.plane = plane;
      this.draw();
    }));
    views.forEach((b, i) => b.setAttribute('aria-pressed', planes[i] === this.plane));
    this.button('all', 'Show the whole path again', () => this.fit());
    this.draw();
  }

  draw() {
    const [across, up] = this.plane;
    const { series } = this.spec;
    this.build({
      mode: 2,
      cursor: {
        drag: { x: true, y: true, setScale: false },
        dataIdx: (u, s) => this.nearest(u, s),
        bind: { dblclick: () => () => this.fit() },
      },
      // Before it is ready it has no size.
      hooks: {
        ready: [() => this.fit()],
        setSelect: [(u) => this.zoomToSelection(u)],
        setSize: [(u) => u.status === 1 && this.keepEqual()],
      },
      scales: { x: { time: false, range: [0, 1] }, y: { range: [0, 1] } },
      axes: [axis(`${across} [m]`), axis(`${up} [m]`, { size: 50 })],
      series: [
        null,
        ...series.map(({ name, colour, width }, i) => ({
          label: name,
          stroke: colour,
          width,
          facets: [{ scale: 'x', auto: false }, { scale: 'y', auto: false }],
          paths: (u, s) => this.trace(u, s, this.breaks[i]),
          points: { show: false },
          value: (u, _, s, at) => this.text(s, at),
        })),
      ],
    }, [null, ...series.map((s) => [s[across], s[up]])]);
  }

  trace(u, s, breaks) {
    const [xs, ys] = u.data[s];
    const stroke = new Path2D();
    xs.forEach((x, i) => {
      const at = [u.valToPos(x, 'x', true), u.valToPos(ys[i], 'y', true)];
      if (i === 0 || breaks.has(i)) stroke.moveTo(...at);
      else stroke.lineTo(...at);
    });
    return { stroke, fill: null, clip: null, flags: 0 };
  }

  nearest(u, s) {
    const [xs, ys] = u.data[s];
    let best = null;
    let least = reach * reach;
    xs.forEach((x, i) => {
      const away = (u.valToPos(x, 'x') - u.cursor.left) ** 2 + (u.valToPos(ys[i], 'y') - u.cursor.top) ** 2;
      if (away < least) [best, least] = [i, away];
    });
    return best;
  }

  text(s, at) {
    const path = this.spec.series[s - 1];
    if (at == null) return '';
    const [across, up] = this.plane;
    return `${seconds(path.t[at])}: ${path[across][at].toFixed(3)}, ${path[up][at].toFixed(3)} m`;
  }

  // Everything, but of estimates that stray far off only what lies near the truth.
  fit() {
    const range = this.plane.map((which) => {
      const [truth, ...estimates] = this.spec.series.map((s) => s[which]);
      return { truth: extent(truth, -Infinity, Infinity), estimates };
    });
    const stray = Math.max(strayLeast, ...range.map(({ truth }) => strayFactor * (truth[1] - truth[0])));
    const [x, y] = range.map(({ truth, estimates }) => {
      const shown = estimates.map((e) => extent(e, truth[0] - stray, truth[1] + stray));
      const low = Math.min(truth[0], ...shown.map(([a]) => a));
      const high = Math.max(truth[1], ...shown.map(([, b]) => b));
      const more = margin * Math.max(high - low, 1e-3);
      return [low - more, high + more];
    });
    this.show(x, y);
  }

  // These ranges in the middle, the smaller one widened until a metre is as long both ways.
  show([left, right], [low, high]) {
    const { width, height } = this.plot.over.getBoundingClientRect();
    const scale = Math.max((right - left) / width, (high - low) / height);
    const around = (a, b, pixels) => ({ min: (a + b - scale * pixels) / 2, max: (a + b + scale * pixels) / 2 });
    this.plot.batch(() => {
      this.plot.setScale('x', around(left, right, width));
      this.plot.setScale('y', around(low, high, height));
    });
  }

  keepEqual() {
    const { x, y } = this.plot.scales;
    requestAnimationFrame(() => this.show([x.min, x.max], [y.min, y.max]));
  }

  zoomToSelection(u) {
    const { left, top, width, height } = u.select;
    if (width < 4 && height < 4) return;
    this.show([u.posToVal(left, 'x'), u.posToVal(left + width, 'x')],
      [u.posToVal(top + height, 'y'), u.posToVal(top, 'y')]);
    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  }
}
