// Distance from the truth over time, one line per run.
import uPlot from 'uplot';
import { axis, Chart, gaps, seconds } from './frame.js';

// From this ratio on the smaller error cannot be seen on a linear axis.
const ratioForLogarithm = 4;
const leastError = 0.1;  // mm, on a logarithmic axis

// Times and errors (mm) with a null where frames are missing.
function broken({ t, error }) {
  const breaks = gaps(t);
  const times = [];
  const errors = [];
  t.forEach((time, i) => {
    if (breaks.has(i)) {
      times.push((t[i - 1] + time) / 2);
      errors.push(null);
    }
    times.push(time);
    errors.push(error[i] * 1000);
  });
  return [times, errors];
}

const rms = (values) => Math.sqrt(values.reduce((sum, v) => sum + v * v, 0) / values.length);

export class ErrorChart extends Chart {
  constructor(box, spec) {
    super(box, spec);
    const sizes = spec.series.map((s) => Math.max(rms(s.error) * 1000, leastError));
    this.logarithmic = Math.max(...sizes) > ratioForLogarithm * Math.min(...sizes);
    this.data = uPlot.join(spec.series.map(broken));
    const logarithm = this.button('log', 'Logarithmic axis', (button) => {
      this.logarithmic = !this.logarithmic;
      button.setAttribute('aria-pressed', this.logarithmic);
      this.draw();
    });
    logarithm.setAttribute('aria-pressed', this.logarithmic);
    this.button('all', 'Show the whole time again', () => this.draw());
    this.draw();
  }

  draw() {
    const { series } = this.spec;
    this.build({
      cursor: { y: false, drag: { x: true, y: false }, dataIdx: (u, s, at) => this.nearest(u, s, at) },
      scales: {
        x: { time: false },
        y: this.logarithmic
          ? { distr: 3, clamp: leastError / 10 }
          : { range: (_, __, most) => [0, Math.max(1e-3, (most ?? 1) * 1.05)] },
      },
      axes: [axis('time [s]'), axis('error [mm]', { size: 50 })],
      series: [
        { label: 'time', class: 'time', value: (_, t) => seconds(t) },
        ...series.map(({ name, colour }) => ({
          label: name,
          stroke: colour,
          width: 1.5,
          points: { show: false },
          value: (_, e) => (e == null ? '' : `${e.toFixed(1)} mm`),
        })),
      ],
    }, this.data);
  }

  // The nearest point of a series that has none of its own at this time.
  nearest(u, series, at) {
    const values = u.data[series];
    if (series === 0 || values[at] !== undefined) return at;
    for (let away = 1; away < 8; ++away) {
      if (values[at - away] != null) return at - away;
      if (values[at + away] != null) return at + away;
    }
    return at;
  }
}
