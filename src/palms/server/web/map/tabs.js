// Tabs, as the ARIA practices have them: arrow keys move, one tab is in the order of focus.

/**
 * @param {Element} list with role `tablist`
 * @param {(id: string) => void} onChange is told the id of the panel that is shown now
 * @returns {(id: string) => void} shows a panel
 */
export function makeTabs(list, onChange) {
  const tabs = /** @type {HTMLElement[]} */ ([...list.querySelectorAll('[role=tab]')]);
  const panelOf = (/** @type {HTMLElement} */ tab) => tab.getAttribute('aria-controls') ?? '';
  const choose = (/** @type {HTMLElement} */ chosen) => {
    for (const tab of tabs) {
      const isChosen = tab === chosen;
      tab.setAttribute('aria-selected', String(isChosen));
      tab.tabIndex = isChosen ? 0 : -1;
      const panel = document.getElementById(panelOf(tab));
      if (panel) panel.hidden = !isChosen;
    }
    onChange(panelOf(chosen));
  };
  tabs.forEach((tab, i) => {
    tab.addEventListener('click', () => choose(tab));
    tab.addEventListener('keydown', ({ key }) => {
      const to = { ArrowRight: i + 1, ArrowLeft: i - 1, Home: 0, End: -1 }[key];
      if (to === undefined) return;
      const next = tabs.at(to % tabs.length) ?? tab;
      choose(next);
      next.focus();
    });
  });
  return (id) => choose(tabs.find((tab) => panelOf(tab) === id) ?? tabs[0]);
}
