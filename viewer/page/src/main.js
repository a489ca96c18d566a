import './style.css';
import { Box3 } from 'three';
import { ErrorChart, TimesChart } from './charts.js';
import { load } from './container.js';
import { MapLayers } from './map.js';
import { Model } from './model.js';
import { Paths } from './paths.js';
import { Picture } from './picture.js';
import { column } from './rows.js';
import { Stage } from './stage.js';
import { Status } from './status.js';
import { listen } from './ticks.js';
import { Transport } from './transport.js';

const byId = (id) => document.getElementById(id);
const chartInterval = 250;    // milliseconds
const errorInterval = 1000;

const model = new Model();
const status = new Status(model);
const transport = new Transport(model);
const picture = new Picture(byId('picture'), byId('picture-note'));
const times = new TimesChart(byId('times'));
let errors = null;  // made when it is first shown, at its true width
let world = null;
try {
  const stage = new Stage(byId('world-canvas'));
  world = { stage, paths: new Paths(stage, model), map: new MapLayers(stage, model) };
} catch {
  byId('no-webgl').hidden = false;
}

function chip(parent, name, checked, use) {
  const label = document.createElement('label');
  const box = document.createElement('input');
  box.type = 'checkbox';
  box.checked = checked;
  box.onchange = () => use(box.checked);
  label.append(box, name);
  byId(parent).append(label);
  return box;
}

function addChips() {
  if (world) {
    const { stage, paths, map } = world;
    const layer = (object) => (on) => {
      object.visible = on;
      stage.draw();
    };
    chip('layers', 'path', true, layer(paths.path));
    chip('layers', 'truth', true, layer(paths.truth)).parentElement.id = 'truth-chip';
    chip('layers', 'keyframes', true, layer(map.keyframes));
    chip('layers', 'covisibility', true, layer(map.covisibility));
    chip('layers', 'landmarks', true, layer(map.landmarks));
    chip('layers', 'dense cloud', false, (on) => {
      layer(map.dense)(on);
      attempt(map.fillDense());
    }).parentElement.id = 'dense-chip';
  }
  for (const name of Object.keys(picture.marks)) {
    chip('marks', name, true, (on) => {
      picture.marks[name] = on;
      picture.draw();
    }).parentElement.dataset.mark = name;
  }
}

// A server that has gone is no fault of the page: the stream says so.
function attempt(promise) {
  promise.catch(() => {});
}

let following = true;
function setFollowing(on) {
  following = on;
  // From what the view turns about now to the camera.
  if (world) world.stage.followed = on ? world.stage.controls.target.clone() : null;
  byId('follow').setAttribute('aria-pressed', String(on));
}

function showAll() {
  if (!world) return;
  const box = new Box3();
  world.map.extend(box);
  world.paths.extend(box);
  setFollowing(false);
  world.stage.show(box);
}

let chartsDue = 0;
function showRow() {
  const row = transport.row;
  status.show(row);
  document.body.dataset.rows = model.rows.count;
  if (row < 0) return;
  const frame = model.rows.get(row, column.index);
  document.body.dataset.frame = frame;
  attempt(picture.show(frame, transport.held === null));
  if (world) {
    world.map.showMap(model.rows.get(row, column.map));
    const place = world.paths.showRow(row);
    if (place && following) world.stage.follow(place);
  }
  if (performance.now() < chartsDue) return;
  chartsDue = performance.now() + chartInterval;
  times.show(model.rows, row);
}

let errorDue = 0;
let errorEnd = '';
async function showError() {
  if (!model.hasTruth) return;
  byId('error-panel').hidden = false;
  const end = `${model.newest} ${model.finished}`;
  if (performance.now() < errorDue || end === errorEnd) return;
  errorDue = performance.now() + errorInterval;
  errors ??= new ErrorChart(byId('error'));
  const answer = await load('/api/error');
  if (!answer || answer.head.matches === 0) return;
  errorEnd = end;
  const { rmse, max } = answer.head;
  byId('error-note').textContent =
    `RMSE ${(1000 * rmse).toFixed(1)} mm, at most ${(1000 * max).toFixed(1)} mm`;
  errors.show(answer.section('times', Float64Array), answer.section('errors', Float32Array),
    model.start);
  world?.paths.showTruth(answer.section('truth', Float32Array));
}

model.addEventListener('begin', () => {
  picture.begin();
  world?.paths.begin(model.info.camera);
  world?.map.begin();
  if (world) world.stage.followed = null;
  errorEnd = '';
  byId('error-panel').hidden = true;
  // A file keeps no images, so no picture, times or dense cloud either.
  const map = model.info.kind === 'map';
  for (const id of ['picture-panel', 'times-panel']) byId(id).hidden = map;
  for (const id of ['dense-chip', 'truth-chip']) if (byId(id)) byId(id).hidden = map;
  document.querySelector('footer').hidden = map;
  byId('follow').hidden = map;
});
model.addEventListener('frames', ({ detail }) => {
  if (!world) return;
  if (detail.reset) world.paths.restart();
  world.paths.grow();
});
model.addEventListener('map', ({ detail }) => {
  world?.map.apply(detail);
  if (model.info.kind === 'map' && model.keyframes.size > 0) {
    const maps = [...model.keyframes.values()].map((keyframe) => keyframe.map);
    world?.map.showMap(maps.at(-1));
    showAll();
  }
});
model.addEventListener('update', () => {
  showRow();
  attempt(showError());
  if (world) attempt(world.map.fillDense());
});
transport.addEventListener('row', () => {
  chartsDue = 0;
  showRow();
});

byId('follow').onclick = () => {
  setFollowing(!following);
  showRow();
};
byId('fit').onclick = showAll;
addEventListener('keydown', (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key === 'f') setFollowing(!following);
  if (event.key === 'a') showAll();
});

addChips();
listen(
  () => attempt(model.pull()),
  (connection) => {
    status.connection = connection;
    status.show(transport.row);
  });
attempt(model.pull());
// What was held back by an interval is shown when nothing more comes.
setInterval(() => {
  if (transport.row < 0 || document.hidden) return;
  showRow();
  attempt(showError());
}, 1000);
