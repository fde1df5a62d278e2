// Theme: light or dark, as the system has it until somebody chooses.

const CHOICE = 'palms-theme';

/**
 * @param {HTMLButtonElement} button turns dark on and off
 * @param {() => void} onChange
 */
export function makeTheme(button, onChange) {
  const system = matchMedia('(prefers-color-scheme: dark)');
  const root = document.documentElement;
  const isDark = () => (root.dataset.theme ? root.dataset.theme === 'dark' : system.matches);
  const show = () => {
    button.setAttribute('aria-pressed', String(isDark()));
    onChange();
  };
  const chosen = localStorage.getItem(CHOICE);
  if (chosen) root.dataset.theme = chosen;
  button.addEventListener('click', () => {
    root.dataset.theme = isDark() ? 'light' : 'dark';
    localStorage.setItem(CHOICE, root.dataset.theme);
    show();
  });
  system.addEventListener('change', show);
  button.setAttribute('aria-pressed', String(isDark()));
}
