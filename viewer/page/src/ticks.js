// Calls `onTick` when there is something new, and `onState` with true (connected) or why not.

function withoutWorker(onMessage) {
  const source = new EventSource('/api/stream');
  source.onmessage = () => onMessage('tick');
  source.onerror = () => {
    const refused = source.readyState === EventSource.CLOSED;
    onMessage(refused ? 'refused' : 'lost');
    if (refused) setTimeout(() => withoutWorker(onMessage), 3000);
  };
}

function withWorker(onMessage) {
  const worker = new SharedWorker('/ticks.js', { name: 'dkp-slam ticks' });
  worker.port.onmessage = ({ data }) => onMessage(data);
  worker.port.postMessage('hello');
  addEventListener('pagehide', () => worker.port.postMessage('bye'));
  addEventListener('pageshow', (event) => event.persisted && worker.port.postMessage('hello'));
}

export function listen(onTick, onState) {
  const onMessage = (message) => {
    if (message === 'tick') {
      onState('connected');
      onTick();
    } else {
      onState(message);
    }
  };
  if ('SharedWorker' in window) withWorker(onMessage);
  else withoutWorker(onMessage);
}
