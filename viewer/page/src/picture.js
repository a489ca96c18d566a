// The image with what was found in it: masks, boxes, features, and which of them were removed.
import { load } from './container.js';
import { colour } from './theme.js';

const region = { low: 0, suspicious: 1, high: 2 };

export class Picture {
  constructor(canvas, note) {
    this.canvas = canvas;
    this.note = note;
    this.marks = { masks: true, boxes: true, features: true, removed: true };
    this.shown = -1;   // frame
    this.wanted = -1;
  }

  begin() {
    this.shown = -1;
    this.image = null;
    this.note.textContent = '';
    this.canvas.getContext('2d').clearRect(0, 0, this.canvas.width, this.canvas.height);
  }

  // Shows this frame's picture, `newest`: whichever is the newest. One question at a time.
  async show(frame, newest) {
    this.wanted = frame;
    this.newest = newest;
    if (this.busy) return;
    this.busy = true;
    try {
      while (this.shown !== this.wanted) {
        const wanted = this.wanted;
        const answer = await load(this.newest ? '/api/picture' : `/api/picture?frame=${wanted}`);
        if (!answer) {
          this.note.textContent = 'none kept of this frame';
          this.shown = wanted;
        } else {
          await this.take(answer, wanted);
        }
        if (this.newest) break;  // the next update asks for the next
      }
    } finally {
      this.busy = false;
    }
    // The server may have had none newer yet.
    if (this.newest && this.shown !== this.wanted) {
      clearTimeout(this.retry);
      this.retry = setTimeout(() => this.show(this.wanted, this.newest).catch(() => {}), 100);
    }
  }

  async take(answer, wanted) {
    const jpeg = answer.section('jpeg', Uint8Array);
    const image = await createImageBitmap(new Blob([jpeg], { type: 'image/jpeg' }));
    this.image?.close();
    this.image = image;
    this.head = answer.head;
    this.features = answer.section('features', Uint16Array);
    // Not every frame has a picture: the nearest one before stands for it.
    this.shown = this.newest ? answer.head.frame : wanted;
    this.draw();
  }

  draw() {
    if (!this.image) return;
    const { canvas, image } = this;
    if (canvas.width !== image.width || canvas.height !== image.height) {
      canvas.width = image.width;
      canvas.height = image.height;
    }
    const context = canvas.getContext('2d');
    context.drawImage(image, 0, 0);
    if (this.marks.masks) this.drawMasks(context);
    const removed = this.drawFeatures(context);
    if (this.marks.boxes) this.drawBoxes(context);
    const count = this.features.length / 3;
    this.note.textContent = `frame ${this.head.frame}, ${removed} of ${count} features removed`;
    canvas.dataset.frame = this.head.frame;
  }

  drawMasks(context) {
    const { width, height } = this.canvas;
    context.beginPath();
    for (const outline of this.head.mask) {
      for (let i = 0; i < outline.length; i += 2) {
        const [x, y] = [outline[i] * width, outline[i + 1] * height];
        if (i === 0) context.moveTo(x, y);
        else context.lineTo(x, y);
      }
      context.closePath();
    }
    context.globalAlpha = 0.32;
    context.fillStyle = colour('removed');
    context.fill('evenodd');
    context.globalAlpha = 1;
    context.lineWidth = 1.5;
    context.strokeStyle = colour('removed');
    context.stroke();
  }

  drawFeatures(context) {
    const { width, height } = this.canvas;
    const inks = [colour('static'), colour('suspicious'), colour('removed')];
    const dots = inks.map(() => new Path2D());
    const crosses = inks.map(() => new Path2D());
    let removed = 0;
    for (let i = 0; i < this.features.length; i += 3) {
      const x = (this.features[i] / 65535) * width;
      const y = (this.features[i + 1] / 65535) * height;
      const where = this.features[i + 2] & 3;
      if (this.features[i + 2] & 4) {
        dots[where].moveTo(x + 2.2, y);
        dots[where].arc(x, y, 2.2, 0, 2 * Math.PI);
      } else {
        ++removed;
        crosses[where].moveTo(x - 3.5, y - 3.5);
        crosses[where].lineTo(x + 3.5, y + 3.5);
        crosses[where].moveTo(x - 3.5, y + 3.5);
        crosses[where].lineTo(x + 3.5, y - 3.5);
      }
    }
    for (const where of Object.values(region)) {
      // A dark rim, so that a mark shows on any background.
      for (const [ink, extra] of [['#101418', 2], [inks[where], 0]]) {
        context.strokeStyle = ink;
        context.fillStyle = ink;
        if (this.marks.features) {
          context.lineWidth = extra;
          if (extra > 0) context.stroke(dots[where]);
          else context.fill(dots[where]);
        }
        if (this.marks.removed) {
          context.lineWidth = 1.5 + extra;
          context.stroke(crosses[where]);
        }
      }
    }
    return removed;
  }

  drawBoxes(context) {
    const { width, height } = this.canvas;
    context.font = '600 13px system-ui, sans-serif';
    context.textBaseline = 'top';
    for (const { name, box, score, carried } of this.head.objects) {
      const [x, y, w, h] = [box[0] * width, box[1] * height, box[2] * width, box[3] * height];
      context.lineWidth = 2;
      context.strokeStyle = carried ? '#f0e442' : '#ffffff';
      context.setLineDash(carried ? [7, 5] : []);
      context.strokeRect(x, y, w, h);
      context.setLineDash([]);
      const label = carried ? `${name} carried` : `${name} ${score.toFixed(2)}`;
      const at = [Math.max(0, x), Math.max(0, y)];
      context.fillStyle = 'rgb(16 20 24 / 0.8)';
      context.fillRect(at[0], at[1], context.measureText(label).width + 8, 18);
      context.fillStyle = carried ? '#f0e442' : '#ffffff';
      context.fillText(label, at[0] + 4, at[1] + 3);
    }
  }
}
