// Times of the stages and error against the truth, over the run.
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { column } from './rows.js';
import { colour, onSchemeChange } from './theme.js';

const shownFrames = 300;  // in the chart of times
const stages = [
  ['whole frame', column.frame, 'stage-frame', []],
  ['features', column.feature, 'stage-feature', []],
  ['detection', column.detection, 'stage-detection', [6, 3]],
  ['masks', column.masks, 'stage-masks', [2, 3]],
  ['removal', column.removal, 'stage-removal', [8, 3, 2, 3]],
  ['tracking', column.tracking, 'stage-tracking', [4, 2]],
];

function chart(parent, series, height, unit) {
  const build = () => {
    const axis = (extra) => ({
      stroke: colour('quiet'),
      font: '11px system-ui, sans-serif',
      grid: { stroke: colour('line'), width: 1 },
      ticks: { stroke: colour('line'), width: 1, size: 4 },
      ...extra,
    });
    return new uPlot({
      width: Math.max(200, parent.clientWidth),
      height,
      cursor: { y: false, drag: { x: false, y: false } },
      legend: { live: true },
      scales: { x: { time: false }, y: { range: (_, __, most) => [0, Math.max(1, most * 1.1)] } },
      axes: [
        axis({ size: 24, values: (_, ticks) => ticks.map((t) => `${t} s`) }),
        axis({ size: 46 }),
      ],
      series: [
        { label: 'time', value: (_, t) => (t == null ? '' : `${t.toFixed(1)} s`) },
        ...series.map(([label, , ink, dash]) => ({
          label,
          stroke: colour(ink),
          width: 1.6,
          dash,
          points: { show: false },
          value: (_, v) => (v == null ? '' : `${v.toFixed(1)} ${unit}`),
        })),
      ],
    }, [[], ...series.map(() => [])], parent);
  };
  let plot = build();
  let data = plot.data;
  new ResizeObserver(() => plot.setSize({ width: Math.max(200, parent.clientWidth), height }))
    .observe(parent);
  onSchemeChange(() => {
    plot.destroy();
    plot = build();
    plot.setData(data);
  });
  return (values) => {
    data = values;
    plot.setData(values);
  };
}

export class TimesChart {
  constructor(parent) {
    this.set = chart(parent, stages, 150, 'ms');
  }

  // The last frames up to this row.
  show(rows, row) {
    const first = Math.max(0, row - shownFrames + 1);
    const data = Array.from({ length: stages.length + 1 }, () => []);
    for (let i = first; i <= row; ++i) {
      data[0].push(rows.get(i, column.time));
      stages.forEach(([, which], s) => data[s + 1].push(rows.get(i, which)));
    }
    this.set(data);
  }
}

export class ErrorChart {
  constructor(parent) {
    this.set = chart(parent, [['error', null, 'truth', []]], 120, 'mm');
  }

  // `times`: seconds, `errors`: metres.
  show(times, errors, start) {
    this.set([Array.from(times, (t) => t - start), Array.from(errors, (e) => e * 1000)]);
  }
}
