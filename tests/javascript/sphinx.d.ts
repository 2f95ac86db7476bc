/* What Sphinx and MathJax put on every page of the book. */

declare const DOCUMENTATION_OPTIONS: { SHOW_SEARCH_SUMMARY: boolean };

interface Window {
  MathJax?: {
    startup?: { promise?: Promise<void>; typeset?: boolean };
    typesetPromise?: (elements: Element[]) => Promise<void>;
  };
}

/* What cards.js brings: the cards of the book by the addresses of what they show. */

interface BookCard {
  name: string;
  html: string;
  page: string;
}

declare const bookCards: Record<string, BookCard>;

/* Of Sphinx's search: a result is page, title, anchor, description, score, file and kind. */

type SearchResult = [string, string, string, string | null, number, string, string];

declare const Search: {
  query: (text: string) => void;
  _performSearch: (text: string, ...terms: Set<string>[]) => SearchResult[];
};
