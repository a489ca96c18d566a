// The view in three dimensions: renderer, camera, and when to draw. Draws only what has changed.
import {
  Color, ColorManagement, Group, LinearSRGBColorSpace, PerspectiveCamera, Scene, Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';
import { colour, onSchemeChange } from './theme.js';

// Colours go to the screen as the style sheet and the images have them: nothing is lit here.
ColorManagement.enabled = false;

export class Stage {
  // Throws where there is no WebGL.
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, powerPreference: 'low-power' });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(55, 1, 0.02, 500);
    this.camera.position.set(1.2, 1.4, 2.6);
    // Cameras look along z with y down; the page's own up is y.
    this.root = new Group();
    this.root.rotation.x = Math.PI;
    this.root.updateMatrixWorld(true);
    this.scene.add(this.root);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.target.set(0, 0, -1.5);
    this.controls.listenToKeyEvents(canvas);
    this.controls.addEventListener('change', () => this.draw());
    this.controls.update();
    this.resizers = [];
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
    onSchemeChange(() => this.paint());
    this.paint();
  }

  paint() {
    this.scene.background = new Color(colour('space'));
    this.draw();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    for (const use of this.resizers) use(width, height);
    this.draw();
  }

  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.renderer.render(this.scene, this.camera);
    });
  }

  // A point of the world frame as the page has it.
  place(x, y, z) {
    return new Vector3(x, -y, -z);
  }

  // Moves along with something that is now at `point`.
  follow(point) {
    if (this.followed) {
      const step = point.clone().sub(this.followed);
      this.camera.position.add(step);
      this.controls.target.add(step);
      this.controls.update();
    }
    this.followed = point;
  }

  // Turns to see a box, from the direction that it has.
  show(box) {
    if (box.isEmpty()) return;
    const centre = box.getCenter(new Vector3());
    const radius = Math.max(0.3, box.getSize(new Vector3()).length() / 2);
    const direction = this.camera.position.clone().sub(this.controls.target).normalize();
    const fov = (this.camera.fov * Math.PI) / 360;
    const narrow = Math.min(1, this.camera.aspect);
    this.controls.target.copy(centre);
    this.camera.position.copy(centre).addScaledVector(direction, radius / Math.sin(fov) / narrow);
    this.controls.update();
    this.draw();
  }
}
