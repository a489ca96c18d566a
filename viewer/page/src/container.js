// Answers of the server that are part JSON, part numbers (viewer/container.h).

export class Container {
  constructor(buffer) {
    const length = new DataView(buffer).getUint32(0, true);
    this.head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
    this.buffer = buffer;
    this.start = Math.ceil((4 + length) / 8) * 8;
  }

  // A section as a typed array, without a copy.
  section(name, Type) {
    const [offset, bytes] = this.head.sections[name] ?? [0, 0];
    return new Type(this.buffer, this.start + offset, bytes / Type.BYTES_PER_ELEMENT);
  }
}

// Null where there is nothing (yet). Throws where the server refuses or has gone.
export async function load(path) {
  const answer = await fetch(path, { cache: 'no-store' });
  if (answer.status === 204 || answer.status === 404) return null;
  if (!answer.ok) throw new Error((await answer.text()).trim() || `status ${answer.status}`);
  return new Container(await answer.arrayBuffer());
}
