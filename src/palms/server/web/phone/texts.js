// The page's own words: a catalogue for each language, English where there is none.

export const LANGUAGES = ['en', 'de'];

/**
 * Return the catalogue's language for what somebody prefers.
 *
 * @param {readonly string[]} wanted such as `navigator.languages`
 */
export function languageFor(wanted) {
  const found = wanted.map((tag) => tag.toLowerCase().split('-')[0]);
  return found.find((language) => LANGUAGES.includes(language)) ?? LANGUAGES[0];
}

/**
 * Put values into a text's placeholders, `{name}`.
 *
 * @param {string} text
 * @param {Record<string, string | number>} values
 */
export function filled(text, values) {
  return text.replace(/\{(\w+)\}/g, (whole, name) => String(values[name] ?? whole));
}

/** The words of one language. */
export class Texts {
  /**
   * @param {string} language
   * @param {Record<string, string>} catalogue
   */
  constructor(language, catalogue) {
    this.language = language;
    this.catalogue = catalogue;
  }

  /**
   * Load a language.
   *
   * @param {string} language
   */
  static async load(language) {
    const answer = await fetch(new URL(`texts/${language}.json`, import.meta.url));
    return new Texts(language, await answer.json());
  }

  /**
   * Return a text; the key itself where there is none, which a test forbids.
   *
   * @param {string} key
   * @param {Record<string, string | number>} [values]
   */
  of(key, values = {}) {
    return filled(this.catalogue[key] ?? key, values);
  }

  /**
   * Put the words into a page: into each element what its `data-text` names, and into its
   * `aria-label` what its `data-label` names.
   *
   * @param {ParentNode} root
   */
  fill(root) {
    for (const element of root.querySelectorAll('[data-text]')) {
      element.textContent = this.of(element.getAttribute('data-text') ?? '');
    }
    for (const element of root.querySelectorAll('[data-label]')) {
      element.setAttribute('aria-label', this.of(element.getAttribute('data-label') ?? ''));
    }
  }
}
