// SPDX-License-Identifier: BSD-3-Clause
// wasi.js -- the part of WASI (preview 1) that weft's WebAssembly calls: arguments, a clock,
// messages, and files in memory, which can only be read.
const [BADF, NOENT] = [8, 44];
const [CHARACTERS, FOLDER, REGULAR] = [2, 3, 4];
const ROOT = 3; // the descriptor of the one folder, "/"

/** files: path -> Uint8Array; write(descriptor, text) gets what the program prints. */
export function wasi({ args = [], files = new Map(), write = () => {} } = {}) {
    const open = new Map();
    const argv = args.map((text) => new TextEncoder().encode(`${text}\0`));
    let memory;
    const view = () => new DataView(memory.buffer);
    const bytes = (at, size) => new Uint8Array(memory.buffer, at, size);
    const pathAt = (at, size) => new TextDecoder().decode(bytes(at, size)).replace(/^\.?\//, '');
    const fileAt = (at, size) => files.get(pathAt(at, size));
    /** The names of the files in a folder, "/", "scenes" or "scenes/."; null: there is no such folder. */
    const namesIn = (folder) => {
        const start = folder.replace(/\/?\.?$/, '/').replace(/^\//, '');
        const inside = [...files.keys()].filter((name) => name.startsWith(start)).map((name) => name.slice(start.length));
        return start === '' || inside.length > 0 ? inside.filter((name) => !name.includes('/')) : null;
    };
    const put32 = (at, value) => view().setUint32(at, value, true);
    const put64 = (at, value) => view().setBigUint64(at, BigInt(value), true);

    const describe = (at, size) => {
        bytes(at, 64).fill(0);
        view().setUint8(at + 16, REGULAR);
        put64(at + 32, size);
        return 0;
    };
    /** Calls each(part) of the parts of memory that a call names, until it returns a short count. */
    const parts = (at, count, total, each) => {
        let sum = 0;
        for (let i = 0; i < count; ++i) {
            const part = bytes(view().getUint32(at + 8 * i, true), view().getUint32(at + 8 * i + 4, true));
            const done = each(part);
            sum += done;
            if (done < part.length) {
                break;
            }
        }
        put32(total, sum);
        return 0;
    };

    const calls = {
        args_sizes_get: (count, size) => {
            put32(count, argv.length);
            put32(size, argv.reduce((sum, { length }) => sum + length, 0));
            return 0;
        },
        args_get: (list, at) => {
            for (const text of argv) {
                put32(list, at);
                bytes(at, text.length).set(text);
                list += 4;
                at += text.length;
            }
            return 0;
        },
        environ_sizes_get: (count, size) => {
            put32(count, 0);
            put32(size, 0);
            return 0;
        },
        environ_get: () => 0,
        clock_time_get: (id, precision, at) => {
            put64(at, Math.round(performance.now() * 1e6));
            return 0;
        },
        proc_exit: (code) => {
            throw Object.assign(new Error(`exit ${code}`), { code });
        },
        fd_prestat_get: (fd, at) => {
            put32(at, 0);
            put32(at + 4, 1);
            return fd === ROOT ? 0 : BADF;
        },
        fd_prestat_dir_name: (fd, at) => {
            bytes(at, 1)[0] = '/'.charCodeAt(0);
            return 0;
        },
        fd_fdstat_get: (fd, at) => {
            bytes(at, 24).fill(0);
            view().setUint8(at, fd === ROOT || open.get(fd)?.names ? FOLDER : fd < ROOT ? CHARACTERS : REGULAR);
            bytes(at + 8, 16).fill(255); // all rights
            return fd <= ROOT || open.has(fd) ? 0 : BADF;
        },
        fd_fdstat_set_flags: () => 0,
        fd_filestat_get: (fd, at) => (open.has(fd) ? describe(at, open.get(fd).file.length) : BADF),
        path_filestat_get: (fd, flags, path, size, at) => {
            const file = fileAt(path, size);
            return file ? describe(at, file.length) : NOENT;
        },
        path_open: (fd, flags, path, size, how, rights, inherited, mode, at) => {
            const file = fileAt(path, size);
            const names = file ? null : namesIn(pathAt(path, size));
            if (!file && !names) {
                return NOENT;
            }
            let next = ROOT + 1;
            while (open.has(next)) {
                ++next;
            }
            open.set(next, { file: file ?? new Uint8Array(), at: 0, names });
            put32(at, next);
            return 0;
        },
        fd_close: (fd) => (open.delete(fd) ? 0 : BADF),
        fd_read: (fd, at, count, total) => {
            const from = open.get(fd);
            return from ? parts(at, count, total, (part) => {
                const some = from.file.subarray(from.at, from.at + part.length);
                part.set(some);
                from.at += some.length;
                return some.length;
            }) : BADF;
        },
        /** Entries from the one numbered `from` on, the last cut off where there is no more room. */
        fd_readdir: (fd, at, size, from, used) => {
            const names = open.get(fd)?.names;
            let sum = 0;
            for (let i = Number(from); names && i < names.length && sum < size; ++i) {
                const name = new TextEncoder().encode(names[i]);
                const entry = new Uint8Array(24 + name.length);
                const numbers = new DataView(entry.buffer);
                numbers.setBigUint64(0, BigInt(i + 1), true);
                numbers.setBigUint64(8, BigInt(i + 1), true); // of a file: not 0
                numbers.setUint32(16, name.length, true);
                numbers.setUint8(20, REGULAR);
                entry.set(name, 24);
                const some = entry.subarray(0, size - sum);
                bytes(at + sum, some.length).set(some);
                sum += some.length;
            }
            put32(used, sum);
            return names ? 0 : BADF;
        },
        fd_seek: (fd, by, whence, at) => {
            const of = open.get(fd);
            if (!of) {
                return BADF;
            }
            of.at = Number(by) + [0, of.at, of.file.length][whence];
            put64(at, of.at);
            return 0;
        },
        fd_write: (fd, at, count, total) => parts(at, count, total, (part) => {
            write(fd, new TextDecoder().decode(part));
            return part.length;
        }),
    };
    return {
        imports: { wasi_snapshot_preview1: calls },
        attach: (instance) => {
            ({ memory } = instance.exports);
        },
    };
}
