// SPDX-License-Identifier: Apache-2.0
// Functions on the canvases of the report, for browser_test_report.py.
({
    // Pixels of colours of the style sheet, or of any colour (null): count, distances from the edges, extent / canvas size.
    pixels: (id, names) => {
        const { width: w, height: h } = document.getElementById(id);
        const copy = new OffscreenCanvas(w, h).getContext('2d', { willReadFrequently: true });
        copy.drawImage(document.getElementById(id), 0, 0);
        const pixels = copy.getImageData(0, 0, w, h).data;
        const style = getComputedStyle(document.documentElement);
        return names.map((name) => {
            const hex = name && style.getPropertyValue('--' + name).trim();
            const rgb = name && [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
            let count = 0, [left, top, right, bottom] = [w, h, 0, 0];
            for (let i = 0; i < pixels.length; i += 4) {
                if (name ? rgb.every((v, k) => pixels[i + k] === v) && pixels[i + 3] === 255 : pixels[i + 3]) {
                    const [x, y] = [(i / 4) % w, Math.floor(i / 4 / w)];
                    [left, top] = [Math.min(left, x), Math.min(top, y)];
                    [right, bottom] = [Math.max(right, x), Math.max(bottom, y)];
                    count++;
                }
            }
            const margin = Math.min(left, top, w - 1 - right, h - 1 - bottom);
            return [count, margin, Math.max(right - left, bottom - top) / Math.min(w, h)];
        });
    },

    // Calls of a method while a canvas is drawn: arguments, width of the text, alignment, font.
    calls: (id, method) => {
        const g = document.getElementById(id).getContext('2d');
        const calls = [];
        g[method] = (...all) => calls.push([...all.slice(0, 3), g.measureText(all[0]).width, g.textAlign, g.font]);
        window.dispatchEvent(new Event('resize'));
        delete g[method];
        window.dispatchEvent(new Event('resize'));
        return calls;
    },

    axis: (id) => {
        const copy = new OffscreenCanvas(60, 174).getContext('2d');
        copy.drawImage(document.getElementById(id), 0, 0);
        return copy.getImageData(0, 0, 60, 174).data.join();
    },

    // Number of pixels within r of a point of the scene that have the colour of angles within the limits.
    green: (x, y, r) => {
        const copy = new OffscreenCanvas(2 * r, 2 * r).getContext('2d');
        copy.drawImage(document.getElementById('scene'), r - Math.round(x), r - Math.round(y));
        const pixels = copy.getImageData(0, 0, 2 * r, 2 * r).data;
        const hex = getComputedStyle(document.documentElement).getPropertyValue('--good').trim();
        const rgb = [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
        return pixels.filter((_, i) => !(i % 4) && rgb.every((v, k) => pixels[i + k] === v)).length;
    },
})
