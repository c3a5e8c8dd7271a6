// SPDX-License-Identifier: BSD-3-Clause
// stage.js -- camera, light, floor; a view for each run, side by side under one camera.
import {
    AmbientLight, Box3, DirectionalLight, DoubleSide, HemisphereLight, Mesh, PCFShadowMap, PerspectiveCamera,
    PlaneGeometry, Raycaster, Scene, ShaderMaterial, ShadowMaterial, Vector2, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { direction } from './camera.js';
import { Cloth, RestShape } from './cloth.js';
import { extent } from './data.js';
import { Shapes } from './shapes.js';
import { clothOf } from './surface.js';

const MARGIN = 1.12;
const HEAD = 44; // px above panes that are stacked, for their words
const SMALL = 3; // a cloth that moves through a stage so many times as large is followed

/** 1, 2 or 5 times a power of ten, near x. */
const round = (x) => {
    const power = 10 ** Math.floor(Math.log10(x));
    return power * [1, 2, 5].findLast((m) => m * power <= x * 1.0001);
};

function floorGrid(cell, radius) {
    return new ShaderMaterial({
        transparent: true,
        depthWrite: false,
        side: DoubleSide,
        uniforms: { cell: { value: cell }, radius: { value: radius }, ink: { value: new Vector3() } },
        vertexShader: `varying vec2 at;
            void main() {
                at = position.xy;
                gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
            }`,
        fragmentShader: `varying vec2 at;
            uniform float cell, radius;
            uniform vec3 ink;
            void main() {
                vec2 place = at / cell;
                vec2 wide = fwidth(place);
                vec2 line = 1.0 - smoothstep(vec2(0.4), vec2(1.4), abs(fract(place - 0.5) - 0.5) / wide);
                float fade = 1.0 - smoothstep(0.25, 1.0, length(at) / radius);
                gl_FragColor = vec4(ink, max(line.x, line.y) * fade * 0.22);
            }`,
    });
}

/** Whether pictures are drawn by the processor alone: then shadows and smooth edges
 * would cost the motion. */
export function isSoftware() {
    const context = document.createElement('canvas').getContext('webgl2');
    const info = context?.getExtension('WEBGL_debug_renderer_info');
    const name = info ? context.getParameter(info.UNMASKED_RENDERER_WEBGL) : '';
    context?.getExtension('WEBGL_lose_context')?.loseContext();
    return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

const cornersOf = ([x, y, z]) => [0, 1, 2, 3, 4, 5, 6, 7].map((i) => new Vector3(x[i & 1], y[(i >> 1) & 1], z[i >> 2]));

export class Stage {
    /** Throws where there is no WebGL. `fine`: shadows and smooth edges. */
    constructor(canvas, page, boxes, fine) {
        this.page = page;
        this.canvas = canvas;
        this.direction = direction(page);
        this.surround(boxes);
        this.following = this.size > this.scale;
        this.close = this.following;
        this.renderer = new WebGLRenderer({ canvas, antialias: fine, alpha: true });
        this.renderer.debug.checkShaderErrors = false; // would wait for each shader
        this.renderer.setScissorTest(true);
        this.renderer.shadowMap.enabled = fine;
        this.renderer.shadowMap.type = PCFShadowMap;
        this.camera = new PerspectiveCamera(32);
        this.controls = new OrbitControls(this.camera, canvas);
        this.controls.addEventListener('change', () => this.request());
        this.build();
        this.stacked = false;
    }

    /** The middle and the size of what is seen. */
    surround(boxes) {
        this.corners = boxes.flatMap(cornersOf);
        this.lo = this.corners.reduce((a, b) => a.min(b), new Vector3().setScalar(Infinity));
        this.hi = this.corners.reduce((a, b) => a.max(b), new Vector3().setScalar(-Infinity));
        this.centre = this.lo.clone().add(this.hi).multiplyScalar(0.5);
        this.size = this.lo.distanceTo(this.hi) || 1;
        const largest = Math.max(...boxes.map((sides) => Math.hypot(...sides.map(([lo, hi]) => hi - lo))));
        this.scale = Math.min(this.size, SMALL * largest || 1); // of what is seen at a time
    }

    /** Everything that has to do with the size of what is seen. */
    build() {
        Object.assign(this.camera, { near: this.scale / 100, far: this.size * 60 });
        Object.assign(this.controls, { minDistance: this.scale / 40, maxDistance: this.size * 20 });
        Object.assign(this, { cell: round(this.size / 4), grid: null, shade: null });
        this.views = this.page.runs.map((run) => this.makeView(run));
        this.addRest();
    }

    /** One more pane, for the rest shape. */
    addRest() {
        this.rest = null;
        if (this.resting) {
            const scene = new Scene();
            this.rest = new RestShape(this.page.surface.rest, this.centre.toArray(), this.size);
            scene.add(this.rest.group, new AmbientLight('#ffffff', 2.9));
            this.views.push({ scene });
        }
    }

    setRest(on) {
        this.resting = on;
        this.views.length = this.page.runs.length;
        this.addRest();
        this.resize();
    }

    /** Of a run under way: more frames, perhaps farther away. Returns whether all is new. */
    widen(boxes) {
        const { lo, hi } = this;
        this.surround(boxes);
        if (lo.equals(this.lo) && hi.equals(this.hi)) {
            return false;
        }
        this.views.forEach(({ scene }) => scene.traverse((object) => {
            [object.geometry, object.material, object.shadow].forEach((part) => part?.dispose());
        }));
        this.build();
        this.resize();
        return true;
    }

    makeView(run) {
        const scene = new Scene();
        const cloth = new Cloth(this.page, run, this.scale);
        const shapes = new Shapes(this.page, run, this.size);
        const key = new DirectionalLight('#fff4e6', 2.8);
        key.position.copy(this.centre).addScaledVector(new Vector3(-0.62, 1, 0.75).normalize(), 2 * this.size);
        key.target.position.copy(this.centre);
        this.castShadows(key);
        const fill = new DirectionalLight('#dce8ff', 1.1);
        fill.position.set(0.9, -0.15, 0.8);
        scene.add(cloth.group, shapes.group, new HemisphereLight('#ffffff', '#a19c94', 1.4), key, key.target, fill);
        this.addFloor(scene);
        return { scene, cloth, shapes };
    }

    castShadows(light) {
        const reach = 0.75 * this.size;
        light.castShadow = true;
        light.shadow.mapSize.set(1024, 1024);
        Object.assign(light.shadow.camera, {
            left: -reach, right: reach, top: reach, bottom: -reach, near: this.size / 4, far: 4 * this.size,
        });
        light.shadow.normalBias = 0.006 * this.size;
        light.shadow.bias = -0.0006;
        light.shadow.radius = 3;
    }

    addFloor(scene) {
        const radius = 1.5 * this.size;
        const ground = new PlaneGeometry(2 * radius, 2 * radius);
        this.grid ??= floorGrid(this.cell, radius);
        this.shade ??= new ShadowMaterial({ depthWrite: false });
        const layers = this.renderer.shadowMap.enabled ? [this.grid, this.shade] : [this.grid];
        for (const [i, material] of layers.entries()) {
            const floor = new Mesh(ground, material);
            floor.rotation.x = -Math.PI / 2;
            floor.position.set(this.centre.x, this.lo.y - 0.05 * this.size, this.centre.z);
            floor.receiveShadow = i === 1;
            floor.renderOrder = -1 - i;
            scene.add(floor);
        }
    }

    setInk(dark) {
        this.grid.uniforms.ink.value.setScalar(dark ? 0.75 : 0.1);
        this.shade.opacity = dark ? 0.45 : 0.2;
        this.views.forEach(({ cloth }) => cloth?.setInk(dark));
        this.request();
    }

    setThreads(on) {
        for (const { cloth } of this.views.slice(0, this.page.runs.length)) {
            cloth.lines.visible = on || cloth.chain;
        }
        this.request();
    }

    /** Returns how many times smaller than the floor's squares say it is drawn. */
    show(frame, quantity) {
        const { centre, scale } = this.page.all ? extent(this.page, frame, this.size) : { scale: 1 };
        const place = scale > 1 ? { from: centre, scale, to: this.centre.toArray() } : null;
        for (const { cloth, shapes } of this.views.slice(0, this.page.runs.length)) {
            const held = this.page.all ? frame : Math.min(frame, cloth.run.held ?? frame);
            cloth.show(held, quantity, place);
            cloth.fade(held < frame);
            shapes.show(frame, place);
        }
        this.rest?.show(this.views[0].cloth);
        this.follow();
        this.request();
        return scale;
    }

    resize() {
        const { clientWidth: width, clientHeight: height } = this.canvas;
        const ratio = Math.min(window.devicePixelRatio, 2);
        this.renderer.setPixelRatio(ratio);
        this.renderer.setSize(width, height, false);
        this.stacked = width < height;
        const head = this.stacked && this.page.runs.length > 1 ? HEAD : 0;
        this.panes = this.views.map((_, i) => {
            const share = i / this.views.length;
            return this.stacked
                ? [0, height - (share + 1 / this.views.length) * height, width, height / this.views.length - head]
                : [share * width, 0, width / this.views.length, height];
        });
        this.camera.aspect = this.panes[0][2] / this.panes[0][3];
        this.camera.updateProjectionMatrix();
        if (!this.moved) {
            this.fit();
        }
        this.request();
    }

    /** The box around the cloths as they are drawn. */
    present() {
        const box = new Box3();
        for (const { cloth } of this.views.slice(0, this.page.runs.length)) {
            box.union(new Box3().setFromBufferAttribute(cloth.geometry.attributes.position));
        }
        return box;
    }

    setFollowing(on) {
        this.following = on;
        this.middle = null;
        this.follow();
    }

    /** Moves the camera as the cloth has moved since it was last asked to. */
    follow() {
        if (!this.following) {
            return;
        }
        const middle = this.present().getCenter(new Vector3());
        const way = middle.clone().sub(this.middle ?? middle);
        this.camera.position.add(way);
        this.controls.target.add(way);
        this.middle = middle;
        this.controls.update();
    }

    /** As near as the boxes of all frames stay in view, or if `close` those of the present one. */
    fit(close = this.close) {
        const { camera, controls } = this;
        this.close = close;
        const { min, max } = this.present();
        const corners = close ? cornersOf([0, 1, 2].map((k) => [min.getComponent(k), max.getComponent(k)])) : this.corners;
        const [centre, least] = close
            ? [min.clone().add(max).multiplyScalar(0.5), min.distanceTo(max) / 4 || this.size / 4]
            : [this.centre, this.size / 4];
        const tall = Math.tan((camera.fov * Math.PI) / 360) / MARGIN;
        const right = new Vector3(0, 1, 0).cross(this.direction).normalize();
        const up = this.direction.clone().cross(right);
        const target = centre.clone();
        // Perspective shifts the middle of what is seen: look there, then again.
        let distance = 0;
        for (let pass = 0; pass < 4; ++pass) {
            const place = (axis, slope) => {
                const near = corners.map((corner) => {
                    const from = corner.clone().sub(target);
                    return [from.dot(axis) / slope, from.dot(this.direction)];
                });
                const ahead = Math.max(...near.map(([x, depth]) => depth + x));
                const behind = Math.max(...near.map(([x, depth]) => depth - x));
                target.addScaledVector(axis, ((ahead - behind) / 2) * slope);
                return (ahead + behind) / 2;
            };
            distance = Math.max(place(right, tall * camera.aspect), place(up, tall), least);
        }
        controls.target.copy(target);
        camera.position.copy(target).addScaledVector(this.direction, distance);
        controls.update();
        this.request();
    }

    /** The name of the one of several cloths at a place of the window; null: none is there. */
    clothAt({ clientX, clientY }) {
        const frame = this.canvas.getBoundingClientRect();
        const [x, y] = [clientX - frame.left, frame.bottom - clientY];
        const pane = this.panes.findIndex(([left, low, width, height]) => x >= left && x < left + width && y >= low && y < low + height);
        const view = this.views[pane];
        if (!view?.cloth) {
            return null;
        }
        const [left, low, width, height] = this.panes[pane];
        const ray = new Raycaster();
        ray.setFromCamera(new Vector2((2 * (x - left)) / width - 1, (2 * (y - low)) / height - 1), this.camera);
        view.cloth.geometry.computeBoundingSphere();
        const [hit] = ray.intersectObjects([view.cloth.surface, ...view.shapes.group.children]);
        const { surface } = this.page;
        return hit?.object === view.cloth.surface ? surface.cloths[clothOf(surface, hit.face.a)].name : null;
    }

    /** Draw once, with the next picture of the browser. */
    request() {
        if (!this.pending) {
            this.pending = requestAnimationFrame(() => this.draw());
        }
    }

    draw() {
        this.pending = 0;
        this.views.forEach(({ scene }, i) => {
            this.renderer.setViewport(...this.panes[i]);
            this.renderer.setScissor(...this.panes[i]);
            this.renderer.render(scene, this.camera);
        });
    }
}
