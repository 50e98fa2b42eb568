// Numbers as text.

export const minus = (text) => text.replace("-", "\u2212");

/** Six digits, for what moves; a number that is null is a dash. */
export function brief(value, digits = 6) {
  if (value === null || value === undefined) return "\u2013";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-4) return minus(value.toExponential(Math.max(digits - 3, 1)));
  return minus(value.toPrecision(digits));
}

/** Three digits, for ends of axes. */
export const short = (value) => minus(String(Number(value.toPrecision(3))));

/** All digits: the shortest text that gives the same double; small numbers without zeros before them. */
export const full = (value) => (Math.abs(value) < 1e-4 && value !== 0 ? value.toExponential() : String(value));

/** "x (km)". */
export const axisText = ({ name, unit }) => (unit ? `${name} (${unit})` : name);

/** Round values of an axis: with powers of ten where the largest is very large or very small. */
export function axisNumbers(values) {
  const largest = Math.max(...values.map(Math.abs));
  const scientific = largest >= 1e6 || largest < 1e-3;
  const text = (value) => (scientific && value ? Number(value.toPrecision(4)).toExponential() : String(value));
  return values.map((value) => minus(text(Number(value.toPrecision(8)))));
}

/** Round values within a range, some `count` of them, with their texts. */
export function ticks(low, high, count) {
  const wanted = (high - low) / Math.max(count, 1);
  const power = 10 ** Math.floor(Math.log10(wanted));
  const step = [1, 2, 5, 10].find((leading) => wanted <= leading * power * (1 + 1e-9)) * power;
  const list = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) list.push(k * step);
  const largest = Math.max(Math.abs(low), Math.abs(high));
  const scientific = largest >= 1e6 || largest < 1e-3;
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const text = (value) =>
    minus(
      scientific
        ? Math.abs(value) < 1e-9 * largest
          ? "0"
          : Number(value.toPrecision(4)).toExponential()
        : value.toFixed(decimals),
    );
  return list.map((at) => ({ at, text: text(Math.abs(at) < 1e-9 * step ? 0 : at) }));
}
