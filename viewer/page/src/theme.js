// Colours of the page, as the style sheet has them for the light or the dark scheme.

export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

export function onSchemeChange(use) {
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', use);
}
