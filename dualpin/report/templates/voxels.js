"use strict";
// slices through maps of a workspace, and the robot that turns
(() => {
  const colour = t => {  // from dark blue over green to yellow, readable in grey
    const stops = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
    const x = Math.min(Math.max(t, 0), 1) * 4, i = Math.min(Math.floor(x), 3), f = x - i;
    return stops[i].map((c, k) => Math.round(c + f * (stops[i + 1][k] - c)));
  };
  const short = x => Math.abs(x) >= 1e4 || (x && Math.abs(x) < 1e-3) ? x.toExponential(2) : +x.toPrecision(3);

  document.querySelectorAll(".voxels").forEach(box => {
    const data = JSON.parse(box.querySelector("script").textContent), n = data.shape, ACROSS = [2, 1, 0];
    const layers = data.layers.map(l => Uint8Array.from(atob(l.bytes), c => c.charCodeAt(0)));
    const select = box.querySelector("select"), read = box.querySelector(".read");
    const figures = [...box.querySelectorAll("figure")];
    const bar = box.querySelector(".scale canvas").getContext("2d");
    for (let i = 0; i < 180; i++) { bar.fillStyle = `rgb(${colour(i / 179)})`; bar.fillRect(i, 0, 1, 10); }
    const at = (across, k, i, j) => {
      const p = across === 2 ? [i, j, k] : across === 1 ? [i, k, j] : [k, i, j];
      return (p[0] * n[1] + p[1]) * n[2] + p[2];
    };
    const place = (axis, k) => data.origin[axis] + data.cell * (k + 0.5);
    const draw = () => {
      const layer = data.layers[+select.value], bytes = layers[+select.value];
      box.querySelector(".low").textContent = short(layer.low);
      box.querySelector(".high").textContent = short(layer.high);
      figures.forEach((figure, f) => {
        const across = ACROSS[f], [a, b] = [0, 1, 2].filter(k => k !== across), canvas = figure.querySelector("canvas");
        const k = +figure.querySelector("input").value;
        figure.querySelector("output").textContent = place(across, k).toFixed(2);
        canvas.width = n[a]; canvas.height = n[b];
        const context = canvas.getContext("2d"), image = context.createImageData(n[a], n[b]);
        for (let j = 0; j < n[b]; j++) {
          for (let i = 0; i < n[a]; i++) {
            const value = bytes[at(across, k, i, j)], o = 4 * ((n[b] - 1 - j) * n[a] + i);
            if (value) { image.data.set([...colour((value - 1) / 254), 255], o); }
          }
        }
        context.putImageData(image, 0, 0);
      });
    };
    figures.forEach((figure, f) => {
      const across = ACROSS[f], [a, b] = [0, 1, 2].filter(k => k !== across);
      const input = figure.querySelector("input"), canvas = figure.querySelector("canvas");
      input.max = n[across] - 1; input.value = data.middle[across];
      input.addEventListener("input", draw);
      canvas.addEventListener("pointermove", e => {
        const r = canvas.getBoundingClientRect();
        const i = Math.floor((e.clientX - r.left) / r.width * n[a]), j = n[b] - 1 - Math.floor((e.clientY - r.top) / r.height * n[b]);
        if (i < 0 || j < 0 || i >= n[a] || j >= n[b]) { return; }
        const layer = data.layers[+select.value], value = layers[+select.value][at(across, +input.value, i, j)];
        const p = []; p[across] = place(across, +input.value); p[a] = place(a, i); p[b] = place(b, j);
        const says = value ? short(layer.low + (value - 1) / 254 * (layer.high - layer.low)) : "not reached";
        read.textContent = `(${p.map(x => x.toFixed(2)).join(", ")}) m: ${says}`;
      });
    });
    select.addEventListener("input", draw);
    draw();
  });

  // the robot: sliders move its joints, dragging turns the view
  const times = (A, B) => {
    const C = new Array(12);
    for (let r = 0; r < 3; r++) {
      for (let c = 0; c < 4; c++) {
        C[4 * r + c] = A[4 * r] * B[c] + A[4 * r + 1] * B[4 + c] + A[4 * r + 2] * B[8 + c] + (c === 3 ? A[4 * r + 3] : 0);
      }
    }
    return C;
  };
  const moved = ([x, y, z], t, d) => {  // a turn by t about the axis and a slide by d along it
    const c = Math.cos(t), s = Math.sin(t), v = 1 - c;
    return [x * x * v + c, x * y * v - z * s, x * z * v + y * s, x * d,
            y * x * v + z * s, y * y * v + c, y * z * v - x * s, y * d,
            z * x * v - y * s, z * y * v + x * s, z * z * v + c, z * d];
  };
  document.querySelectorAll(".skeleton").forEach(box => {
    const data = JSON.parse(box.querySelector("script").textContent), svg = box.querySelector("svg");
    const lines = [...svg.querySelectorAll("line")], q = data.q.slice();
    let azimuth = data.azimuth, elevation = data.elevation, grabbed = null;
    const draw = () => {
      const world = [];
      data.joints.forEach(j => {
        let t = j.offset[0], d = j.offset[1];
        j.terms.forEach(([i, turn, slide]) => { t += turn * q[i]; d += slide * q[i]; });
        const fixed = j.parent < 0 ? j.placement : times(world[j.parent], j.placement);
        world.push(j.axis ? times(fixed, moved(j.axis, t, d)) : times(fixed, j.still));
      });
      const ca = Math.cos(azimuth), sa = Math.sin(azimuth), ce = Math.cos(elevation), se = Math.sin(elevation);
      const seen = (joint, p) => {
        const T = joint < 0 ? [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0] : world[joint];
        const [x, y, z] = [0, 4, 8].map(r => T[r] * p[0] + T[r + 1] * p[1] + T[r + 2] * p[2] + T[r + 3] - data.centre[r / 4]);
        return [ca * y - sa * x, -(ce * z - se * (ca * x + sa * y))];
      };
      const drawn = data.lines.map(([joint, from, to]) => [...seen(joint, from), ...seen(joint, to)]);
      const scale = Math.min(data.scale, 190 / Math.max(...drawn.flat().map(Math.abs)));  // nothing leaves the drawing
      drawn.forEach((line, k) => ["x1", "y1", "x2", "y2"].forEach((name, i) => lines[k].setAttribute(name, (scale * line[i]).toFixed(1))));
    };
    svg.addEventListener("pointerdown", e => { grabbed = [e.clientX, e.clientY]; svg.setPointerCapture(e.pointerId); });
    svg.addEventListener("pointerup", () => { grabbed = null; });
    svg.addEventListener("pointermove", e => {
      if (!grabbed) { return; }
      azimuth -= (e.clientX - grabbed[0]) / 100;
      elevation = Math.min(1.57, Math.max(-1.57, elevation + (e.clientY - grabbed[1]) / 100));
      grabbed = [e.clientX, e.clientY];
      draw();
    });
    box.querySelectorAll("input").forEach(input => input.addEventListener("input", () => { q[+input.name] = +input.value; draw(); }));
  });
})();
