// What all charts share: a box with buttons above and the plot below, as wide as the page lets it.
import uPlot from 'uplot';

const height = 320;
const quiet = '#59636e';
const line = '#e3e8ed';

export function axis(name, extra) {
  return {
    label: name,
    labelSize: 22,
    labelFont: '12px system-ui, sans-serif',
    font: '11px system-ui, sans-serif',
    stroke: quiet,
    grid: { stroke: line, width: 1 },
    ticks: { stroke: line, width: 1, size: 4 },
    ...extra,
  };
}

function addButton(bar, text, title, use) {
  const button = document.createElement('button');
  button.type = 'button';
  button.textContent = text;
  button.title = title;
  button.addEventListener('click', () => use(button));
  bar.append(button);
  return button;
}

// A chart that can be made anew with other options, keeping which series are shown.
export class Chart {
  constructor(box, spec) {
    this.box = box;
    this.spec = spec;
    this.bar = document.createElement('div');
    this.bar.className = 'bar';
    const title = document.createElement('b');
    title.textContent = spec.title;
    this.bar.append(title);
    box.append(this.bar);
    this.plot = null;
    new ResizeObserver(() => this.plot?.setSize(this.size())).observe(box);
  }

  // Buttons come before the first `build`; the last of them shows everything again.
  button(text, title, use) {
    return addButton(this.bar, text, title, use);
  }

  size() {
    return { width: Math.max(240, this.box.clientWidth), height };
  }

  // `options`: those of uPlot but for size and legend.
  build(options, data) {
    const shown = this.plot?.series.map((s) => s.show);
    this.plot?.destroy();
    options.series.forEach((s, i) => {
      if (s && shown) s.show = shown[i];
    });
    this.plot = new uPlot({ ...this.size(), legend: { live: true }, ...options }, data, this.box);
    for (const label of this.box.querySelectorAll('.u-legend tr:not(:has(.time)) th')) {
      label.tabIndex = 0;
      label.title = 'show or hide';
      label.addEventListener('keydown', (event) => {
        if (event.key !== 'Enter' && event.key !== ' ') return;
        event.preventDefault();
        label.click();
      });
    }
    // The wheel zooms about the cursor, with Ctrl, so that the page can be scrolled.
    this.plot.over.addEventListener('wheel', (event) => {
      if (!event.ctrlKey && !event.shiftKey) return;
      event.preventDefault();
      this.zoomAt(event.offsetX, event.offsetY, (event.deltaY || event.deltaX) > 0 ? 1.25 : 0.8);
    }, { passive: false });
  }

  zoomAt(left, top, factor) {
    const about = (key, at) => {
      const { min, max } = this.plot.scales[key];
      return { min: at - (at - min) * factor, max: at + (max - at) * factor };
    };
    const x = about('x', this.plot.posToVal(left, 'x'));
    const y = this.zoomsBoth ? about('y', this.plot.posToVal(top, 'y')) : null;
    this.plot.batch(() => {
      this.plot.setScale('x', x);
      if (y) this.plot.setScale('y', y);
    });
  }
}

// Indices i where what comes before lies several usual intervals back: frames were lost there.
export function gaps(times) {
  const intervals = times.slice(1).map((t, i) => t - times[i]);
  const longest = 4 * ([...intervals].sort((a, b) => a - b)[intervals.length >> 1] ?? 0);
  return new Set(intervals.flatMap((length, i) => (length > longest ? [i + 1] : [])));
}

export const seconds = (t) => (t == null ? '' : `${t.toFixed(2)} s`);
