// Charts of a report: each <div class="chart"> holds what is to be drawn as JSON.
import 'uplot/dist/uPlot.min.css';
import './style.css';
import { ErrorChart } from './error_chart.js';
import { HistogramChart } from './histogram_chart.js';
import { PathChart } from './path_chart.js';

const kinds = { paths: PathChart, errors: ErrorChart, histogram: HistogramChart };

for (const box of document.querySelectorAll('.chart')) {
  const spec = JSON.parse(box.querySelector('script').textContent);
  box.chart = new kinds[spec.kind](box, spec);
}
