// Shared by all pages of a browser, which may have only six connections to one server: one stream
// for all of them, that says when there is something new.
const ports = new Set();
let source = null;
let last = null;

function tell(message) {
  last = message;
  for (const port of ports) port.postMessage(message);
}

function open() {
  if (source) return;
  source = new EventSource('/api/stream');
  source.onmessage = () => tell('tick');
  source.onerror = () => {
    const refused = source.readyState === EventSource.CLOSED;
    tell(refused ? 'refused' : 'lost');
    if (!refused) return;  // else the browser itself tries again
    source = null;
    setTimeout(() => ports.size > 0 && open(), 3000);
  };
}

self.onconnect = (event) => {
  const port = event.ports[0];
  port.onmessage = ({ data }) => {
    if (data === 'bye') {
      ports.delete(port);
    } else {
      ports.add(port);
      open();
      if (last) port.postMessage(last);
    }
  };
};
