// storage.js: works on this device, in IndexedDB: what each is painted on, and its journal, a record for each stroke, which is
// on the disk before the next one begins.

const databaseName = 'tangipaint', version = 1, lowRoom = 8e6;  // [bytes] below which a painter is warned

const done = request => new Promise((resolve, reject) => {
  request.onsuccess = () => resolve(request.result);
  request.onerror = () => reject(request.error);
});
const finished = transaction => new Promise((resolve, reject) => {
  transaction.oncomplete = () => resolve();
  transaction.onabort = transaction.onerror = () => reject(transaction.error ?? new Error('the storage gave up'));
});

export class Storage {
  // newer(): another tab, of a newer version, waits to change how works are kept; what is still to be kept must be, before what
  // it promises.
  static async open(newer = () => {}) {
    const request = indexedDB.open(databaseName, version);
    request.onupgradeneeded = () => {
      const base = request.result;
      base.createObjectStore('works', {keyPath: 'id'});
      base.createObjectStore('strokes', {keyPath: ['work', 'number']});
      base.createObjectStore('pictures');  // [work, 'ground' | 'relief' | 'thumbnail'] -> Blob
    };
    const storage = new Storage();
    storage.base = await done(request);
    storage.base.onversionchange = async () => {
      await newer();
      storage.base.close();
    };
    return storage;
  }
  // A work is open in one tab at a time: strokes of two would take each other's place. False where another has it.
  async take(id) {
    if (this.taken === id || !navigator.locks) return true;
    this.give();
    await this.lock;
    return new Promise(resolve => {
      this.lock = navigator.locks.request(`tangipaint-${id}`, {ifAvailable: true}, lock => {
        if (lock) this.taken = id;
        resolve(lock !== null);
        return lock && new Promise(given => { this.given = given; });
      });
    });
  }
  give() {
    this.given?.();
    this.given = this.taken = null;
  }
  transaction(stores, mode) {
    // On the disk, not only in the system's hands: a battery may die.
    return this.base.transaction(stores, mode, {durability: 'strict'});
  }

  // Works without what they are made of: {id, title, choice, head, created, changed, strokes}; the one changed last first.
  async works() {
    const all = await done(this.transaction('works', 'readonly').objectStore('works').getAll());
    return all.sort((a, b) => b.changed - a.changed);
  }
  work(id) { return done(this.transaction('works', 'readonly').objectStore('works').get(id)); }
  // choice: web/engine/ground.h; pictures: Blobs.
  async begin({title, choice, picture = null, relief = null, head = null}) {
    const now = Date.now(), id = `${now.toString(36)}-${crypto.getRandomValues(new Uint32Array(1))[0].toString(36)}`;
    const work = {id, title, choice, head, created: now, changed: now, strokes: 0};
    const transaction = this.transaction(['works', 'pictures'], 'readwrite'), pictures = transaction.objectStore('pictures');
    transaction.objectStore('works').add(work);
    if (picture) pictures.put(picture, [id, 'ground']);
    if (relief) pictures.put(relief, [id, 'relief']);
    await finished(transaction);
    return work;
  }
  // Changes some of a work's fields.
  async change(id, fields) {
    const transaction = this.transaction('works', 'readwrite'), store = transaction.objectStore('works');
    const work = await done(store.get(id));
    if (work) store.put({...work, ...fields});
    await finished(transaction);
  }
  picture(id, kind) { return done(this.transaction('pictures', 'readonly').objectStore('pictures').get([id, kind])); }
  // The painting file that a work is painted on, a Blob; null where that is another support.
  async original({id, choice}) { return choice.painting ? this.picture(id, 'ground') : null; }
  async keepThumbnail(id, blob) {
    const transaction = this.transaction('pictures', 'readwrite');
    transaction.objectStore('pictures').put(blob, [id, 'thumbnail']);
    await finished(transaction);
  }
  // One stroke's lines, or those of another event, after all before it.
  async append(id, number, text) {
    const transaction = this.transaction(['works', 'strokes'], 'readwrite'), works = transaction.objectStore('works');
    transaction.objectStore('strokes').put({work: id, number, text});
    const work = await done(works.get(id));
    if (work) works.put({...work, changed: Date.now(), strokes: number + 1});
    await finished(transaction);
  }
  // What the engine refused.
  async drop(id, number) {
    const transaction = this.transaction('strokes', 'readwrite');
    transaction.objectStore('strokes').delete([id, number]);
    await finished(transaction);
  }
  // The journal's lines from a record on, each with its end, and the number of the next record.
  async journal(id, from = 0) {
    const range = IDBKeyRange.bound([id, from], [id, Infinity]);
    const records = await done(this.transaction('strokes', 'readonly').objectStore('strokes').getAll(range));
    return {text: records.map(r => r.text).join(''), next: records.length ? records.at(-1).number + 1 : from};
  }
  async remove(id) {
    const transaction = this.transaction(['works', 'strokes', 'pictures'], 'readwrite');
    transaction.objectStore('works').delete(id);
    transaction.objectStore('strokes').delete(IDBKeyRange.bound([id, 0], [id, Infinity]));
    transaction.objectStore('pictures').delete(IDBKeyRange.bound([id, ''], [id, '\uffff']));
    await finished(transaction);
  }

  // {persists, used, left [bytes], low}; the browser's estimate, where it has one.
  async room() {
    const {usage = 0, quota = Infinity} = await navigator.storage?.estimate?.() ?? {};
    const persists = await navigator.storage?.persisted?.() ?? false;
    return {persists, used: usage, left: quota - usage, low: quota - usage < lowRoom};
  }
  // Asks that the browser clears nothing by itself. Some ask the user, some decide alone.
  persist() { return navigator.storage?.persist?.() ?? Promise.resolve(false); }
}

export const isFull = error => error?.name === 'QuotaExceededError';
