// memory_image.js: the engine's memory as it is, in a file on this device (OPFS, in a worker), so that a work opens as quickly as
// the file is read, with all that can be undone, instead of being painted again. There is one, of the work painted on last. What
// counts is the journal: an image of another engine, work or support is as good as none.

const names = ['engine-memory-0', 'engine-memory-1'], pageBytes = 65536, chunkBytes = 256 * pageBytes;
const startBytes = 16;  // where the head is, and how long

const folder = () => navigator.storage.getDirectory();
// A file's handle, which has it alone; null where there is no such file, or another tab has it.
async function opened(name, create = false) {
  try {
    return await (await (await folder()).getFileHandle(name, {create})).createSyncAccessHandle();
  } catch {
    return null;
  }
}
const remove = async name => (await folder()).removeEntry(name).catch(() => {});
// [[from, to], …]: the bytes of memory, in whole pages, that are not zero.
function filled(memory) {
  const words = new Uint32Array(memory.buffer, 0, memory.length / 4), runs = [];
  for (let from = 0; from < memory.length; from += pageBytes) {
    const end = Math.min(from + pageBytes, memory.length) / 4;
    let i = from / 4;
    while (i < end && words[i] === 0) ++i;
    if (i === end) continue;
    if (runs.length && runs.at(-1)[1] === from) runs.at(-1)[1] = 4 * end;
    else runs.push([from, 4 * end]);
  }
  return runs;
}

// What its head says, or null where it was not written to its end.
function headOf(handle) {
  const start = new Float64Array(startBytes / 8);
  if (handle.read(start, {at: 0}) < startBytes || !(start[0] >= startBytes) || start[0] + start[1] !== handle.getSize()) return null;
  const text = new Uint8Array(start[1]);
  return handle.read(text, {at: start[0]}) === text.length ? JSON.parse(new TextDecoder().decode(text)) : null;
}
async function write(handle, memory, head, goesOn) {
  handle.truncate(0);
  handle.write(new Uint8Array(startBytes), {at: 0});
  const runs = filled(memory);
  let at = startBytes;
  for (const [first, end] of runs)
    for (let from = first; from < end; from += chunkBytes) {
      const to = Math.min(from + chunkBytes, end);
      if (handle.write(memory.subarray(from, to), {at}) !== to - from) throw new Error('there is no room for it');
      at += to - from;
      if (goesOn && !await goesOn()) throw new Error('the painter goes on');
    }
  const text = new TextEncoder().encode(JSON.stringify({...head, runs, size: memory.length}));
  handle.write(text, {at});
  handle.flush();  // it begins to be one when all of it is there
  handle.write(new Float64Array([at, text.length]), {at: 0});
  handle.flush();
}

// Forgets the image of a work, or of any; one that another tab has stays.
export async function forget(work) {
  for (const name of names) {
    const handle = await opened(name), head = handle && headOf(handle);
    handle?.close();
    if (handle && (!work || !head || head.work === work)) await remove(name);
  }
}

// Keeps what memory() gives once the file is open, {memory, head}, or nothing where that is null. True where it is kept: the one
// before is gone only then. goesOn(), where given, is asked after each 16 MB, and promises whether memory is as it was.
export async function keepImage(memory, goesOn) {
  for (const [i, name] of names.entries()) {
    const handle = await opened(name, true);
    if (!handle) return false;
    if (headOf(handle) && i === 0) {  // the other place is free
      handle.close();
      continue;
    }
    const now = memory();
    try {
      if (!now) return false;
      await write(handle, now.memory, now.head, goesOn);
    } catch (error) {
      console.info('no image of the memory:', error.message);
      handle.truncate(0);  // as where storage is full
      return false;
    } finally {
      handle.close();
    }
    await remove(names[1 - i]);
    return true;
  }
  return false;
}

// The head of the image that isWanted(head), after memoryOf(its size) was filled with it; null where there is none.
export async function recallImage(isWanted, memoryOf) {
  for (const name of names) {
    const handle = await opened(name);
    try {
      const head = handle && headOf(handle);
      if (!head || !isWanted(head)) continue;
      const memory = memoryOf(head.size);
      let at = startBytes, end = 0;
      for (const [from, to] of head.runs) {
        memory.fill(0, end, from);
        if (handle.read(memory.subarray(from, to), {at}) !== to - from) throw new Error('the image of the memory is damaged');
        at += to - from;
        end = to;
      }
      memory.fill(0, end);
      return head;
    } finally {
      handle?.close();
    }
  }
  return null;
}
