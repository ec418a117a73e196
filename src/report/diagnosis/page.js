'use strict';
(() => {
const ROLES = ['measured', 'given', 'refitted', 'mended'];
const NAMES = {given: 'as given'};
const make = (name, attributes, parent) => {
  const element = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return parent.appendChild(element);
};
const digits = (value) => String(Number(value.toPrecision(3)));

// Points and times of every line, from the drawing itself.
const charts = [...document.querySelectorAll('svg[data-frame]')].map((svg) => {
  const [left, right, bottom, top, x0, x1, y0, y1] = svg.dataset.frame.split(' ').map(Number);
  const map = 'map' in svg.dataset;
  const chart = {svg, map, run: svg.dataset.run, left, right, top, bottom,
    x: (at) => x0 + (at - left) / (right - left) * (x1 - x0),
    y: (at) => y0 + (bottom - at) / (bottom - top) * (y1 - y0),
    at: (x) => left + (x - x0) / (x1 - x0) * (right - left)};
  chart.lines = [...svg.querySelectorAll(map ? 'path[data-t]' : 'path.line')].map((path) => {
    const points = [...path.getAttribute('d').matchAll(/[ML](-?[\d.]+) (-?[\d.]+)/g)]
      .map((match) => [Number(match[1]), Number(match[2])]);
    const times = map ? path.dataset.t.split(' ').map(Number) : points.map((point) => chart.x(point[0]));
    return {points, times, role: ROLES.find((role) => path.classList.contains(role)) ?? 'path'};
  });
  chart.marks = make('g', {'class': 'marks'}, svg);
  const readout = document.createElement('p');
  readout.className = 'readout';
  chart.readout = svg.parentNode.insertBefore(readout, svg.nextSibling);
  return chart;
});

// Per role, the point of a chart nearest to a time.
const nearest = (chart, time) => {
  const found = {};
  for (const line of chart.lines) {
    line.times.forEach((at, index) => {
      const far = Math.abs(at - time);
      if (far < 1 && !(found[line.role]?.far <= far)) found[line.role] = {far, point: line.points[index]};
    });
  }
  return found;
};
const shown = (role) => !document.documentElement.classList.contains(`no-${role}`);
const clear = () => charts.forEach((chart) => {
  chart.marks.replaceChildren();
  chart.readout.textContent = '';
});

// A value of a time series; on a map a position, or a model's distance from the measured one.
const words = (chart, role, x, y, measured) => {
  const name = NAMES[role] ?? role;
  if (!chart.map) return `${name} ${digits(chart.y(y))}`.replace(/^path /, '');
  if (role === 'path' || role === 'measured' || !measured) return `(${digits(chart.x(x))}, ${digits(chart.y(y))}) m`;
  const off = Math.hypot(chart.x(x) - chart.x(measured[0]), chart.y(y) - chart.y(measured[1]));
  return `${name} ${digits(off)} m off`;
};

// Marks a time in all charts of a run.
const mark = (run, time) => {
  clear();
  for (const chart of charts.filter((one) => one.run === run)) {
    const texts = [];
    if (!chart.map) {
      const x = chart.at(time);
      if (x < chart.left - 1 || x > chart.right + 1) continue;
      make('path', {'class': 'cursor', d: `M${x} ${chart.top}V${chart.bottom}`}, chart.marks);
    }
    const found = nearest(chart, time);
    for (const [role, {point: [x, y]}] of Object.entries(found)) {
      if (!shown(role)) continue;
      make('circle', {'class': `dot ${role}`, cx: x, cy: y, r: 4}, chart.marks);
      texts.push(words(chart, role, x, y, found.measured?.point));
    }
    chart.readout.textContent = `${time.toFixed(1)} s: ${texts.join(', ')}`;
  }
};

for (const chart of charts) {
  chart.svg.addEventListener('pointermove', (event) => {
    const box = chart.svg.getBoundingClientRect();
    const scale = chart.svg.viewBox.baseVal.width / box.width;
    const [x, y] = [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
    if (!chart.map) {
      mark(chart.run, chart.x(Math.min(Math.max(x, chart.left), chart.right)));
      return;
    }
    let [best, time] = [30, null];
    for (const line of chart.lines) {
      if (!shown(line.role)) continue;
      line.points.forEach((point, index) => {
        const far = Math.hypot(point[0] - x, point[1] - y);
        if (far < best) [best, time] = [far, line.times[index]];
      });
    }
    if (time === null) clear(); else mark(chart.run, time);
  });
  chart.svg.addEventListener('pointerleave', clear);
}

// Buttons that hide a model in all charts.
const present = ROLES.slice(1).filter((role) => document.querySelector(`path.${role}`));
const before = document.querySelector('#paths .plots, #misses .plots');
if (present.length > 1 && before) {
  const bar = document.createElement('div');
  bar.className = 'models';
  bar.append('Show:');
  for (const role of present) {
    const button = document.createElement('button');
    button.type = 'button';
    button.className = role;
    button.textContent = NAMES[role] ?? role;
    button.setAttribute('aria-pressed', 'true');
    button.addEventListener('click', () => {
      const hidden = document.documentElement.classList.toggle(`no-${role}`);
      button.setAttribute('aria-pressed', String(!hidden));
      clear();
    });
    bar.append(button);
  }
  // Beside all charts, so that it can stay in view.
  document.body.insertBefore(bar, before.closest('section'));
}
})();
