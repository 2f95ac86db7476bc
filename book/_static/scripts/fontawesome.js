// In place of the theme's file, which has 1.6 MB of icons for every page: book.css draws those in use.
