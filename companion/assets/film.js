// Runs the shaders: which samples come next, how large a dispatch is, and the film on the device.
//
// Twins: src/render_gpu/schedule.rs, trace.rs and dispatches.rs

function reversed(word) {
  let bits = 0;
  for (let i = 0; i < 32; i++) bits |= ((word >>> i) & 1) << (31 - i);
  return bits >>> 0;
}

// The samples after the first `done`: a power of two of them, at most `most`, with `done` a multiple of their number.
export function nextBlock(done, wanted, most) {
  const fitting = 1 << (31 - Math.clz32(Math.max(1, Math.min(wanted - done, most))));
  const count = done === 0 ? fitting : Math.min(done & -done, fitting);
  return { half: 0, counter: reversed(done), step: (2 ** 32 / count) >>> 0, count };
}

// The number of paths that a dispatch of a kernel should have, learnt from measured times.
//
// Twin: `Budget` in src/render_gpu/schedule.rs
export class Budget {
  paths = data.constants.first_paths;

  learn(paths, took) {
    const { dispatch_ms, growth_limit, budget_limits } = data.constants;
    const ratio = dispatch_ms / Math.max(took, 1e-6);
    // A dispatch far below the budget measures the cost of starting one.
    const least = 2 * paths < this.paths ? this.paths : this.paths / 2;
    const most = growth_limit * this.paths;
    const found = ratio < 0.5 ? Math.min(this.paths, paths) / 2 : clamped(paths * ratio, least, most);
    this.paths = clamped(found, ...budget_limits);
  }
}

// The device with its kernels; all live figures share it.
class Gpu {
  static async open() {
    const adapter = await navigator.gpu.requestAdapter();
    if (!adapter) throw new Error("The browser found no graphics device for WebGPU.");
    return new Gpu(adapter.info ?? {}, await adapter.requestDevice());
  }

  constructor(info, device) {
    this.device = device;
    this.kernels = new Map();
    const names = `${info.vendor} ${info.architecture} ${info.device} ${info.description}`;
    const isSoftware = info.isFallbackAdapter || /llvmpipe|softpipe|swiftshader|swrast|basic render/i.test(names);
    // Software drivers may end loops after some iterations, and count those of all threads that run in step.
    const { iteration_limit, software_threads_in_step, software_busy_threads } = data.constants;
    const inStep = isSoftware ? clamped(info.subgroupMaxSize ?? 0, ...software_threads_in_step) : 1;
    this.iterationLimit = iteration_limit / inStep;
    this.busyThreads = isSoftware ? software_busy_threads : Infinity;
    const group = (...types) =>
      device.createBindGroupLayout({
        entries: types.map((type, binding) => ({ binding, visibility: GPUShaderStage.COMPUTE, buffer: { type } })),
      });
    const [uniform, read, write] = ["uniform", "read-only-storage", "storage"];
    this.groups = [group(uniform, read, read, read, read), group(uniform, read, write, write), group(write)];
    this.layout = device.createPipelineLayout({ bindGroupLayouts: this.groups });
    this.modules = {};
    for (const entry of ["path_trace", "resolve"]) {
      this.modules[entry] = device.createShaderModule({ code: data.programs.shared + data.programs[entry] });
    }
  }

  // A promise of a kernel; equal ones are compiled once.
  kernel(entryPoint, constants) {
    const key = JSON.stringify([entryPoint, constants]);
    const compile = async () => {
      const compute = { module: this.modules[entryPoint], entryPoint, constants };
      return {
        pipeline: await this.device.createComputePipelineAsync({ layout: this.layout, compute }),
        budget: new Budget(),
      };
    };
    if (!this.kernels.has(key)) this.kernels.set(key, compile());
    return this.kernels.get(key);
  }

  bind(group, buffers) {
    const entries = buffers.map((buffer, binding) => ({ binding, resource: { buffer } }));
    return this.device.createBindGroup({ layout: this.groups[group], entries });
  }
}

// A picture in the making: its buffers belong to it alone, so nothing left over from another can get into it.
class Film {
  static async start(gpu, stage, settings, scale) {
    const size = [stage.width, stage.height].map((pixels) => Math.ceil(pixels / scale));
    const { buffers, overrides } = inputs(stage, settings, size);
    // Paths that may be longer than a driver's loops are suspended: see shaders/suspend.wgsl.
    const iterations = settings.depth * (1 + stage.iterations_over_lists) + 1;
    const whole = Math.floor((gpu.iterationLimit - 1) / iterations);
    const suspends = overrides.HIERARCHY === 1 || whole < 1;
    const [kernel, resolver] = await Promise.all([
      gpu.kernel("path_trace", { ...overrides, SUSPENDS: +suspends }),
      gpu.kernel("resolve", {}),
    ]);
    const most = Math.min(stage.block_limit, suspends ? Infinity : whole);
    return new Film(gpu, stage, size, scale, { kernel, resolver, suspends, most }, buffers);
  }

  constructor(gpu, stage, [width, height], scale, plan, inputs) {
    Object.assign(this, { gpu, stage, width, height, scale, ...plan, done: 0, seconds: 0, owned: [] });
    const { constants, records } = data;
    this.tileWidth = view(inputs[0]).getUint32(records.Job.tile_width, true);
    this.tileHeight = constants.workgroup_size / this.tileWidth;
    this.tilesAcross = Math.ceil(width / this.tileWidth);
    this.tiles = this.tilesAcross * Math.ceil(height / this.tileHeight);
    const { UNIFORM, STORAGE, COPY_SRC, COPY_DST, MAP_READ } = GPUBufferUsage;
    const threads = this.suspends ? Math.min(this.tiles * constants.workgroup_size, constants.thread_limit) : 1;
    this.tileLimit = this.suspends ? threads / constants.workgroup_size : this.tiles;
    this.parameters = this.buffer("dispatch", records.Dispatch.stride, UNIFORM | COPY_DST);
    this.blocks = this.buffer("blocks", records.Block.stride, STORAGE | COPY_DST);
    this.counters = this.buffer("counters", records.Counters.stride, STORAGE | COPY_SRC | COPY_DST);
    this.receipt = this.buffer("receipt", records.DispatchCounters.stride, MAP_READ | COPY_DST);
    this.picture = this.buffer("picture", 4 * width * height, STORAGE | COPY_SRC);
    this.shown = this.buffer("shown", 4 * width * height, MAP_READ | COPY_DST);
    const sums = this.buffer("film", constants.pixel_size * width * height, STORAGE);
    const suspended = this.buffer("suspended paths", constants.suspended_size * threads, STORAGE);
    const scene = inputs.map((bytes, i) => {
      const buffer = this.buffer("scene", bytes.length, (i === 0 ? UNIFORM : STORAGE) | COPY_DST);
      gpu.device.queue.writeBuffer(buffer, 0, bytes);
      return buffer;
    });
    const shared = [gpu.bind(0, scene), gpu.bind(1, [this.parameters, this.blocks, sums, this.counters])];
    this.tracing = [...shared, gpu.bind(2, [suspended])];
    this.resolving = [...shared, gpu.bind(2, [this.picture])];
  }

  buffer(label, size, usage) {
    const buffer = this.gpu.device.createBuffer({ label, size: Math.ceil(Math.max(size, 16) / 16) * 16, usage });
    this.owned.push(buffer);
    return buffer;
  }

  destroy() {
    this.owned.forEach((buffer) => buffer.destroy());
  }

  // Runs a kernel and returns a copy of what it left in `from`, from byte `offset` on.
  async run({ pipeline }, groups, count, parameters, [from, offset, to]) {
    const { queue } = this.gpu.device;
    const words = new DataView(new ArrayBuffer(data.records.Dispatch.stride));
    writeWords(words, 0, "Dispatch", { row_count: this.height, ...parameters });
    queue.writeBuffer(this.parameters, 0, words);
    const encoder = this.gpu.device.createCommandEncoder();
    encoder.clearBuffer(this.counters, data.records.Counters.dispatch, data.records.DispatchCounters.stride);
    const pass = encoder.beginComputePass();
    pass.setPipeline(pipeline);
    groups.forEach((group, i) => pass.setBindGroup(i, group));
    pass.dispatchWorkgroups(count);
    pass.end();
    encoder.copyBufferToBuffer(from, offset, to, 0, to.size);
    queue.submit([encoder.finish()]);
    await to.mapAsync(GPUMapMode.READ);
    const bytes = to.getMappedRange().slice(0);
    to.unmap();
    return bytes;
  }

  // The samples of the next pass over the picture.
  block(wanted) {
    const threads = Math.min(this.tiles * data.constants.workgroup_size, this.gpu.busyThreads);
    return nextBlock(this.done, wanted, Math.min(this.most, this.kernel.budget.paths / threads));
  }

  // Traces a block in some tiles from `first` on, repeating the dispatch until no path is suspended. Returns their
  // number.
  async trace(first, block) {
    const { workgroup_size } = data.constants;
    const affordable = clamped(this.kernel.budget.paths / (workgroup_size * block.count), 1, this.tileLimit);
    const left = this.tiles - first;
    const count = Math.ceil(left / Math.ceil(left / Math.floor(affordable)));
    const words = new DataView(new ArrayBuffer(data.records.Block.stride));
    writeWords(words, 0, "Block", block);
    this.gpu.device.queue.writeBuffer(this.blocks, 0, words);
    const [paths, samples] = [count * workgroup_size * block.count, this.pixelsWithin(first, count) * block.count];
    const parameters = { first_tile: first, tile_count: count, block_count: 1, iteration_limit: this.gpu.iterationLimit };
    const { DispatchCounters, Counters } = data.records;
    const from = [this.counters, Counters.dispatch, this.receipt];
    let finished = 0;
    for (let resumes = 0, unfinished = 1; unfinished > 0; resumes = 1) {
      const begin = performance.now();
      const bytes = new DataView(await this.run(this.kernel, this.tracing, count, { ...parameters, resumes }, from));
      const took = performance.now() - begin;
      const counter = (name) => bytes.getUint32(DispatchCounters[name], true);
      const now = counter("finished") + counter("finished_high") * 2 ** 32;
      this.kernel.budget.learn(Math.max(1, (paths * now) / samples), took);
      this.seconds += took / 1000;
      finished += now;
      unfinished = this.suspends ? counter("unfinished") : 0;
      if (counter("stuck") > 0) throw new Error("The driver's loops are too short for this scene.");
    }
    if (finished !== samples) throw new Error(`The device added only ${finished} of ${samples} samples.`);
    return count;
  }

  pixelsWithin(first, count) {
    let pixels = 0;
    for (let tile = first; tile < first + count; tile++) {
      const [x, y] = [(tile % this.tilesAcross) * this.tileWidth, Math.floor(tile / this.tilesAcross) * this.tileHeight];
      pixels += Math.min(this.tileWidth, this.width - x) * Math.min(this.tileHeight, this.height - y);
    }
    return pixels;
  }

  async image() {
    const parameters = { sample_count: this.done, transfer: this.stage.transfer };
    const count = Math.ceil((this.width * this.height) / data.constants.workgroup_size);
    const bytes = await this.run(this.resolver, this.resolving, count, parameters, [this.picture, 0, this.shown]);
    return new ImageData(new Uint8ClampedArray(bytes, 0, 4 * this.width * this.height), this.width, this.height);
  }
}
