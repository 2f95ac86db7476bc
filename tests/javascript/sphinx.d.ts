/* What Sphinx and MathJax put on every page of the book. */

interface Window {
  MathJax?: {
    startup?: { promise?: Promise<void>; typeset?: boolean };
    typesetPromise?: (elements: Element[]) => Promise<void>;
  };
}

/* What cards.js and texts.js bring: cards by the addresses of what they show, texts of pages. */

interface BookCard {
  name: string;
  html: string;
  page: string;
}

declare const bookCards: Record<string, BookCard>;
declare const bookTexts: Record<string, string>;

/* Of Sphinx's search: a result is page, title, anchor, description, score, file and kind. */

type SearchResult = [string, string, string, string | null, number, string, string];

declare const Search: {
  query: (text: string) => void;
  htmlToText: (html: string, anchor?: string) => string;
  _performSearch: (text: string, ...terms: Set<string>[]) => SearchResult[];
};
