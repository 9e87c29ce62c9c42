// web_frames.mjs: the thesis's table 4.1 with the web engine: a stroke back and forth over wet paint on a canvas of 1024 x 768, a sample
// of the pen each 1/60 s; what the engine takes for each with the look of what changed, as texels (BM_Table41 of stroke_bench.cpp is the
// same natively). In Node, by processor time: other programs do not count. Then the supports, as a new painting has them.
// Usage: node bench/web_frames.mjs [APP_FOLDER]   (build/web/app)
import {engineOf} from '../tests/web/node_engine.mjs';

const engine = await engineOf(process.argv[2] ?? 'build/web/app'), width = 1024, height = 768, mm = 0.15, half = width * 0.4;
const milliseconds = () => {
  const {user, system} = process.cpuUsage();
  return (user + system) / 1000;
};
const stroke = (preset, size, paint, load) => engine.apply(JSON.stringify({event: 'stroke', brush: {preset, size_mm: size * mm}, paint, load, seed: 1}));
const point = (t, x, y) => engine.apply(JSON.stringify({event: 'point', t, x: x * mm, y: y * mm, p: 0.6}));
const end = () => engine.apply('{"event":"end"}');

function frames(size, speed) {
  engine.open({substrate: 'canvas', width_mm: width * mm, height_mm: height * mm, pixel_mm: mm});
  for (let pass = 0; pass < 6; ++pass) {  // wherever the brush will go
    stroke('flat', 100, {'Titanium White': 1, 'Ultramarine Blue': 1}, 1.5);
    for (const side of [-1, 1]) point(side + 1, side * (half + 60), 40 * (pass % 3 - 1));
    end();
  }
  engine.refresh(false);
  stroke('round', size, {'Bone Black': 1, 'Diarylide Yellow': 1}, 2);
  const times = [];
  for (let i = 0; i <= 240; ++i) {
    const way = i * speed / 60 % (4 * half), from = milliseconds();
    point(i / 60, way < 2 * half ? way - half : 3 * half - way, 30 * Math.sin(0.05 * i));
    for (const region of engine.refresh(false)) engine.texels(0, region);
    if (i >= 3) times.push(milliseconds() - from);  // the spline waits for its neighbours
  }
  end();
  times.sort((a, b) => a - b);
  return {mean: times.reduce((sum, t) => sum + t, 0) / times.length, p99: times[Math.floor(times.length * 0.99)]};
}
for (const size of [11, 31, 61])
  for (const [words, speed] of [['smooth', 300], ['quick', 1500]]) {
    const {mean, p99} = frames(size, speed);
    console.log(`${`${size} pixels, ${words}`.padEnd(20)} ${(1000 / mean).toFixed(0)} frames/s, ${mean.toFixed(1)} ms, 99 %: ${p99.toFixed(1)} ms`);
  }
for (const substrate of ['linen', 'canvas', 'burlap', 'panel', 'gesso', 'paper']) {
  const from = milliseconds();
  engine.open({substrate, width_mm: 240, height_mm: 180, pixel_mm: 240 / 1400, seed: 1});
  console.log(`${`${substrate}, 1400 x 1050`.padEnd(20)} ${((milliseconds() - from) / 1000).toFixed(2)} s`);
}
