// browser.mjs: a browser without a screen, and the application served to it (web/serve.mjs), for measurements: Chrome DevTools
// Protocol through a pipe, as tests/programs/support/browser.h drives it.
import {spawn} from 'node:child_process';
import {mkdtempSync, readFileSync, readdirSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const root = join(dirname(fileURLToPath(import.meta.url)), '..');

export class Browser {
  static async start(app, flags = []) {
    const browser = new Browser();
    browser.server = spawn('node', [join(root, 'web/serve.mjs'), app, '0'], {stdio: ['ignore', 'pipe', 'inherit']});
    browser.url = await new Promise(resolve => browser.server.stdout.once('data', text => resolve(String(text).trim())));
    browser.profile = mkdtempSync(join(tmpdir(), 'web-bench-'));
    browser.program = spawn(process.env.BROWSER ?? 'chromium-headless-shell', ['--headless', '--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader',
      '--enable-unsafe-swiftshader', '--disable-background-networking', '--remote-debugging-pipe', `--user-data-dir=${browser.profile}`, ...flags, 'about:blank'],
    {stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe']});
    browser.program.stdio[4].on('data', data => browser.take(data));
    const {targetInfos} = await browser.call('Target.getTargets');
    browser.session = (await browser.call('Target.attachToTarget', {targetId: targetInfos.find(t => t.type === 'page').targetId, flatten: true})).sessionId;
    for (const domain of ['Page', 'Runtime']) await browser.call(`${domain}.enable`);
    return browser;
  }
  constructor() { Object.assign(this, {count: 0, waiting: new Map(), arrived: []}); }
  take(data) {
    for (let from = 0, end; from < data.length; from = end + 1) {
      end = data.indexOf(0, from);
      this.arrived.push(data.subarray(from, end < 0 ? data.length : end));
      if (end < 0) return;
      const message = JSON.parse(Buffer.concat(this.arrived));
      this.arrived = [];
      const {resolve, reject} = this.waiting.get(message.id) ?? {};
      this.waiting.delete(message.id);
      if (message.error) reject?.(new Error(message.error.message));
      else resolve?.(message.result);
    }
  }
  call(method, params = {}) {
    const id = ++this.count;
    this.program.stdio[3].write(`${JSON.stringify({id, method, params, ...(this.session ? {sessionId: this.session} : {})})}\0`);
    return new Promise((resolve, reject) => this.waiting.set(id, {resolve, reject}));
  }
  // What a function of this program gives when it runs in the page with these values, or what its promise does.
  async run(work, ...values) {
    const {result, exceptionDetails} = await this.call('Runtime.evaluate', {expression: `(${work})(...${JSON.stringify(values)})`, returnByValue: true, awaitPromise: true});
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }
  async open(width = 1024, height = 768) {
    await this.call('Emulation.setDeviceMetricsOverride', {width, height, deviceScaleFactor: 1, mobile: true});
    await this.call('Page.navigate', {url: this.url});
    await this.until(() => document.documentElement.dataset.ready === 'yes');
  }
  // Also while one page is left for another, which has nothing to tell.
  async until(condition, ...values) {
    while (!await this.run(condition, ...values).catch(() => false)) await new Promise(resolve => setTimeout(resolve, 20));
  }
  // [bytes] Of the renderer that has the page, now and at most: what the system says of the processes that were started.
  memory() {
    const status = pid => Object.fromEntries(readFileSync(`/proc/${pid}/status`, 'utf8').split('\n').map(line => line.split(/:\s+/)));
    const parents = new Map();
    for (const pid of readdirSync('/proc').filter(name => /^\d+$/.test(name)))
      try { parents.set(pid, status(pid).PPid); } catch { /* it has ended */ }
    const ours = pid => pid !== undefined && (pid === String(this.program.pid) || ours(parents.get(pid)));
    const renderers = [...parents.keys()].filter(pid => ours(pid) && readFileSync(`/proc/${pid}/cmdline`, 'utf8').includes('--type=renderer'));
    const kilobytes = key => Math.max(...renderers.map(pid => parseInt(status(pid)[key])));
    return {now: 1024 * kilobytes('VmRSS'), most: 1024 * kilobytes('VmHWM')};
  }
  async close() {
    const ended = new Promise(resolve => this.program.once('exit', resolve));
    this.call('Browser.close').catch(() => {});
    await ended;
    this.server.kill();
    rmSync(this.profile, {recursive: true, force: true});
  }
}
