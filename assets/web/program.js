// Runs the program, compiled for WASI, with nothing of the machine but what is passed here: arguments, clock, random
// numbers, standard output and standard error, and files in memory. `files` has their contents by path, and `told` gets
// each line of standard error. Returns the exit code, standard output and the files afterwards; throws if it breaks.
function weekender(module, args, files, told) {
  const BADF = 8, EXIST = 20, INVAL = 28, ISDIR = 31, NOENT = 44, NOSYS = 52, NOTDIR = 54;
  const UNKNOWN = 0, DIRECTORY = 3, FILE = 4, ALL_RIGHTS = 0xffffffffffffffffn;
  const encoder = new TextEncoder(), said = [new TextDecoder(), new TextDecoder()];
  let memory, output = "", line = "";
  const view = () => new DataView(memory.buffer);
  const bytes = (at, length) => new Uint8Array(memory.buffer, at, length);
  const textAt = (at, length) => new TextDecoder().decode(bytes(at, length));

  // Directories and files by their paths from the root, without a slash at either end.
  const nodes = new Map();
  const makeFile = (data = new Uint8Array()) => ({ type: FILE, data, size: data.length, number: BigInt(nodes.size) });
  const makeDirectory = () => ({ type: DIRECTORY, size: 0, number: BigInt(nodes.size) });
  nodes.set("", makeDirectory());
  for (const [path, data] of Object.entries(files)) nodes.set(path, makeFile(data));
  const resolved = (from, path) => {
    const parts = [];
    for (const part of `${from}/${path}`.split("/")) {
      if (part === "..") parts.pop();
      else if (part && part !== ".") parts.push(part);
    }
    return parts.join("/");
  };
  const parentOf = (path) => nodes.get(path.split("/").slice(0, -1).join("/"));
  const isInside = (path, directory) => path !== directory && path.startsWith(directory && `${directory}/`);
  const grow = (node, size) => {
    if (size > node.data.length) {
      const larger = new Uint8Array(Math.max(size, 2 * node.data.length, 4096));
      larger.set(node.data.subarray(0, node.size));
      node.data = larger;
    }
    if (size > node.size) node.size = size;
  };

  const stream = () => ({ node: { type: UNKNOWN, size: 0, number: 0n, data: new Uint8Array() }, at: 0 });
  const open = [stream(), stream(), stream(), { node: nodes.get(""), path: "", at: 0 }];
  const print = (text, isError) => {
    if (!isError) return (output += text);
    const lines = (line + text).split("\n");
    line = lines.pop();
    lines.forEach((whole) => told(whole));
  };
  // Calls `each` with the parts of a scattered buffer until one is cut short, and stores the sum of what it returns.
  const scattered = (at, count, sumAt, each) => {
    let sum = 0;
    for (let i = 0; i < count; i++) {
      const length = view().getUint32(at + 8 * i + 4, true);
      const done = each(bytes(view().getUint32(at + 8 * i, true), length));
      sum += done;
      if (done < length) break;
    }
    view().setUint32(sumAt, sum, true);
    return 0;
  };
  const stat = (node, at) => {
    bytes(at, 64).fill(0);
    view().setBigUint64(at + 8, node.number, true);
    view().setUint8(at + 16, node.type);
    view().setBigUint64(at + 24, 1n, true);
    view().setBigUint64(at + 32, BigInt(node.size), true);
    return 0;
  };
  // A list of texts: their number and length, and the texts with pointers to them.
  const sizes = (texts, countAt, lengthAt) => {
    view().setUint32(countAt, texts.length, true);
    view().setUint32(lengthAt, texts.reduce((sum, text) => sum + text.length, 0), true);
    return 0;
  };
  const store = (texts, pointers, at) => {
    for (const text of texts) {
      view().setUint32(pointers, at, true);
      bytes(at, text.length).set(text);
      pointers += 4;
      at += text.length;
    }
    return 0;
  };
  const words = ["weekender", ...args].map((word) => encoder.encode(`${word}\0`));
  // With the file that a descriptor stands for, and with the path that lies at an address.
  const withFile = (act) => (number, ...rest) => (open[number] ? act(open[number], ...rest) : BADF);
  const withPath = (act) => withFile((from, at, length, ...rest) => act(resolved(from.path ?? "", textAt(at, length)), ...rest));

  const ours = {
    args_sizes_get: (countAt, lengthAt) => sizes(words, countAt, lengthAt),
    args_get: (pointers, at) => store(words, pointers, at),
    environ_sizes_get: (countAt, lengthAt) => sizes([], countAt, lengthAt),
    environ_get: () => 0,
    clock_time_get(id, _, at) {
      const ms = id === 0 ? Date.now() : performance.now();
      view().setBigUint64(at, BigInt(Math.round(ms * 1e6)), true);
      return 0;
    },
    random_get(at, length) {
      for (let from = 0; from < length; from += 65536) crypto.getRandomValues(bytes(at + from, Math.min(65536, length - from)));
      return 0;
    },
    proc_exit: (code) => { throw { code }; },
    sched_yield: () => 0,
    // The only directory that is open at the start is the root.
    fd_prestat_get: (number, at) => (number === 3 ? (bytes(at, 8).set([0, 0, 0, 0, 1, 0, 0, 0]), 0) : BADF),
    fd_prestat_dir_name: (_, at) => (bytes(at, 1).set(encoder.encode("/")), 0),
    fd_close: (number) => (open[number] ? ((open[number] = undefined), 0) : BADF),
    fd_sync: () => 0,
    fd_fdstat_get: withFile(({ node }, at) => {
      bytes(at, 24).fill(0);
      view().setUint8(at, node.type);
      view().setBigUint64(at + 8, ALL_RIGHTS, true);
      view().setBigUint64(at + 16, ALL_RIGHTS, true);
      return 0;
    }),
    fd_filestat_get: withFile(({ node }, at) => stat(node, at)),
    fd_seek: withFile((file, offset, from, at) => {
      const place = [0, file.at, file.node.size][from] + Number(offset);
      if (!(place >= 0)) return INVAL;
      file.at = place;
      view().setBigUint64(at, BigInt(place), true);
      return 0;
    }),
    fd_read: withFile((file, at, count, sumAt) => scattered(at, count, sumAt, (part) => {
      const piece = file.node.data.subarray(Math.min(file.at, file.node.size), Math.min(file.at + part.length, file.node.size));
      part.set(piece);
      file.at += piece.length;
      return piece.length;
    })),
    fd_write: (number, at, count, sumAt) => withFile((file) => scattered(at, count, sumAt, (part) => {
      if (number < 3) {
        print(said[number - 1].decode(part, { stream: true }), number === 2);
        return part.length;
      }
      grow(file.node, file.at + part.length);
      file.node.data.set(part, file.at);
      file.at += part.length;
      return part.length;
    }))(number),
    fd_readdir: withFile(({ path }, at, length, cookie, usedAt) => {
      const inside = [...nodes].filter(([name]) => isInside(name, path) && !name.slice(path.length + 1).includes("/"));
      let used = 0;
      for (let i = Number(cookie); i < inside.length && used < length; i++) {
        const [name, node] = inside[i], text = encoder.encode(name.split("/").pop()), entry = new Uint8Array(24 + text.length);
        const head = new DataView(entry.buffer);
        head.setBigUint64(0, BigInt(i + 1), true);
        head.setBigUint64(8, node.number, true);
        head.setUint32(16, text.length, true);
        head.setUint8(20, node.type);
        entry.set(text, 24);
        const piece = entry.subarray(0, length - used);
        bytes(at + used, piece.length).set(piece);
        used += piece.length;
      }
      view().setUint32(usedAt, used, true);
      return 0;
    }),
    path_filestat_get: (number, _, at, length, to) => withPath((path) => (nodes.has(path) ? stat(nodes.get(path), to) : NOENT))(number, at, length),
    path_readlink: withPath((path) => (nodes.has(path) ? INVAL : NOENT)),
    path_create_directory: withPath((path) => {
      if (nodes.has(path)) return EXIST;
      if (parentOf(path)?.type !== DIRECTORY) return NOENT;
      nodes.set(path, makeDirectory());
      return 0;
    }),
    path_open: (from, _, at, length, how, rights, inherited, flags, to) => withPath((path) => {
      const [creates, wantsDirectory, isNew, truncates] = [1, 2, 4, 8].map((bit) => (how & bit) !== 0);
      if (nodes.has(path) && isNew) return EXIST;
      if (!nodes.has(path)) {
        if (!creates || parentOf(path)?.type !== DIRECTORY) return NOENT;
        nodes.set(path, makeFile());
      }
      const node = nodes.get(path);
      if (wantsDirectory && node.type !== DIRECTORY) return NOTDIR;
      if (truncates && node.type === DIRECTORY) return ISDIR;
      if (truncates) node.size = 0;
      view().setUint32(to, open.push({ node, path, at: 0 }) - 1, true);
      return 0;
    })(from, at, length),
    path_rename: (from, at, length, to, toAt, toLength) => withPath((old) => withPath((path) => {
      if (nodes.get(old)?.type !== FILE || parentOf(path)?.type !== DIRECTORY) return NOENT;
      if (nodes.get(path)?.type === DIRECTORY) return ISDIR;
      nodes.set(path, nodes.get(old));
      if (path !== old) nodes.delete(old);
      return 0;
    })(to, toAt, toLength))(from, at, length),
    path_unlink_file: withPath((path) => (nodes.get(path)?.type === DIRECTORY ? ISDIR : nodes.delete(path) ? 0 : NOENT)),
  };
  const imports = WebAssembly.Module.imports(module).map(({ name }) => [name, ours[name] ?? (() => NOSYS)]);
  const { exports } = new WebAssembly.Instance(module, { wasi_snapshot_preview1: Object.fromEntries(imports) });
  memory = exports.memory;
  let code = 0;
  try {
    exports._start();
  } catch (end) {
    if (end.code === undefined) throw end;
    code = end.code;
  }
  if (line) told(line);
  const kept = [...nodes].filter(([, { type }]) => type === FILE).map(([path, { data, size }]) => [path, data.slice(0, size)]);
  return { code, output, files: Object.fromEntries(kept) };
}
