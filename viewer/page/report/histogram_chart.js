// How often a value occurs, percent of the frames, as steps.
import uPlot from 'uplot';
import { axis, Chart } from './frame.js';

const steps = 50;

// The value that a hundredth of all exceed; what lies above counts in the last step.
function highestShown(series) {
  const all = series.flatMap(({ values }) => values).sort((a, b) => a - b);
  const at = all[all.length - 1 - Math.floor(all.length / 100)] ?? 1;
  return Math.max(1.05 * at, 1e-3);
}

function shares(values, highest) {
  const result = new Array(steps + 1).fill(0);
  for (const value of values) {
    result[Math.min(steps - 1, Math.floor((value / highest) * steps))] += 100 / values.length;
  }
  result[steps] = result[steps - 1];  // the last step's end
  return result;
}

export class HistogramChart extends Chart {
  constructor(box, spec) {
    super(box, spec);
    this.step = highestShown(spec.series) / steps;
    const edges = Array.from({ length: steps + 1 }, (_, i) => i * this.step);
    this.data = [edges, ...spec.series.map(({ values }) => shares(values, this.step * steps))];
    this.button('all', 'Show all values again', () => this.draw());
    this.draw();
  }

  draw() {
    const { series, x, unit } = this.spec;
    this.build({
      cursor: { y: false, drag: { x: true, y: false } },
      scales: {
        x: { time: false },
        y: { range: (_, __, most) => [0, Math.max(1, (most ?? 1) * 1.1)] },
      },
      axes: [axis(`${x} [${unit}]`), axis('frames [%]', { size: 46 })],
      series: [
        {
          label: x,
          class: 'time',
          value: (_, v) => (v == null ? '' : `${v.toFixed(1)}–${(v + this.step).toFixed(1)} ${unit}`),
        },
        ...series.map(({ name, colour }) => ({
          label: name,
          stroke: colour,
          fill: `${colour}22`,
          width: 1.5,
          paths: uPlot.paths.stepped({ align: 1 }),
          points: { show: false },
          value: (_, v) => (v == null ? '' : `${v.toFixed(1)} %`),
        })),
      ],
    }, this.data);
  }
}
