// Colours of the theme, and those of the result made visible on it.

const dark = () => document.documentElement.dataset.theme === "dark";

/** A variable of the style sheet. */
export const themeColour = (name) =>
  getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

const channels = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16));
const hex = (parts) => `#${parts.map((part) => Math.round(part).toString(16).padStart(2, "0")).join("")}`;

/** Between two colours. */
export function mixed(from, to, weight) {
  const a = channels(from),
    b = channels(to);
  return hex(a.map((part, k) => part + (b[k] - part) * weight));
}

/** A colour that is made for white, as light as a dark page needs. */
export function tone(colour) {
  if (!dark()) return colour;
  const parts = channels(colour);
  const light = (0.299 * parts[0] + 0.587 * parts[1] + 0.114 * parts[2]) / 255;
  const least = 0.58;
  return light >= least
    ? colour
    : hex(parts.map((part) => part + ((255 - part) * (least - light)) / (1 - light)));
}

/** With an opacity. */
export const faded = (colour, opacity) =>
  `${colour}${Math.round(opacity * 255)
    .toString(16)
    .padStart(2, "0")}`;

/** The theme that the reader's system asks for, and a switch. */
export function startTheme(wanted, changed) {
  const system = window.matchMedia("(prefers-color-scheme: dark)");
  const set = (theme) => {
    document.documentElement.dataset.theme = theme;
    changed();
  };
  let chosen = wanted;
  document.documentElement.dataset.theme = chosen ?? (system.matches ? "dark" : "light");
  system.addEventListener("change", () => chosen ?? set(system.matches ? "dark" : "light"));
  return () => set((chosen = dark() ? "light" : "dark"));
}
