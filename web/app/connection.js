// connection.js: the page's side of the worker: questions with promises for answers, and what the engine tells by itself.

export class Connection {
  // on: {changed(parts), board(board), state(state, brush), told(text), failed(message, stroke), progress(part), painted(waiting),
  // died(message)}
  constructor(on) {
    this.on = on;
    this.open = new Map();
    this.count = 0;
    this.worker = new Worker(new URL('./worker.js', import.meta.url), {type: 'module'});
    this.worker.onmessage = ({data}) => this.take(data);
    this.worker.onerror = event => {
      for (const {reject} of this.open.values()) reject(new Error('the engine has stopped'));
      this.open.clear();
      this.on.died(event.message ?? '');
    };
  }
  take(data) {
    if (data.id !== undefined) {
      const {resolve, reject} = this.open.get(data.id) ?? {};
      this.open.delete(data.id);
      if (data.error !== undefined) reject?.(new Error(data.error));
      else resolve?.(data.answer);
      return;
    }
    const {on} = this;
    if (data.event === 'changed') on.changed(data.parts);
    if (data.event === 'board') on.board(data.board);
    if (data.event === 'state') on.state(data.state, data.brush);
    if (data.event === 'told') on.told(data.told);
    if (data.event === 'failed') on.failed(data.message, data.stroke);
    if (data.event === 'progress') on.progress(data.part);
    if (data.event === 'painted') on.painted(data.waiting);
  }
  ask(call, values = {}, transfer = []) {
    const id = ++this.count;
    return new Promise((resolve, reject) => {
      this.open.set(id, {resolve, reject});
      this.worker.postMessage({...values, call, id}, transfer);
    });
  }
  // Lines of the journal that belong to this stroke.
  paint(lines, stroke) { this.worker.postMessage({lines, stroke}); }
  leave(tile) { this.worker.postMessage({left: tile}); }
}
