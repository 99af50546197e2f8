//! A thread that makes the files of kept pictures those of the slots.

use super::folder::{Entry, Folder, WriteFault};
use crate::app::answers::{Answer, Answers};
use crate::app::model::kept::Kept;
use crate::app::model::slots::Slots;
use crate::render_cpu::give_way;
use crate::system::memory::words;
use eframe::egui::Context;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{Builder, JoinHandle};

/// What has become of a picture.
#[derive(Debug)]
pub enum News {
    /// The next window will have it: [`Kept::id`].
    Written(String),
    /// The next window will not have it.
    NotWritten {
        /// [`Kept::id`], if it is about one picture.
        id: Option<String>,
        /// Why, in words for the user. `None` if the user was told before.
        words: Option<String>,
    },
}

/// What is to be on disk.
#[derive(Clone)]
struct Wish {
    entry: Entry,
    /// `None` for a picture that is on its way from there.
    kept: Option<Arc<Kept>>,
}

/// The thread, which starts with the first picture.
struct Running {
    orders: Sender<Vec<Wish>>,
    thread: JoinHandle<()>,
}

/// Has kept pictures written and deleted.
pub struct Keeper {
    folder: Folder,
    limit: u64,
    asked: Vec<Entry>,
    /// Pictures that are in no slot and must not be deleted.
    spared: Vec<Entry>,
    running: Option<Running>,
    news: Answers<News>,
    has_failed: bool,
}

impl Keeper {
    /// Keeps pictures in `folder`. Those of all windows may take `limit` bytes.
    pub fn new(folder: Folder, limit: u64) -> Self {
        Keeper {
            folder,
            limit,
            asked: Vec::new(),
            spared: Vec::new(),
            running: None,
            news: Answers::default(),
            has_failed: false,
        }
    }

    /// The folder.
    pub fn folder(&self) -> &Folder {
        &self.folder
    }

    /// Leaves the files of a picture as they are that is in no slot.
    pub fn spare(&mut self, entry: Entry) {
        self.spared.push(entry);
    }

    /// Has the files made those of the slots, if these have changed.
    pub fn follow(&mut self, context: &Context, slots: &Slots) {
        let wishes = self.wishes(slots);
        let is_asked = wishes.len() == self.asked.len()
            && wishes.iter().zip(&self.asked).all(|(wish, asked)| wish.entry == *asked);
        if !is_asked {
            self.send(context, wishes);
        }
    }

    fn send(&mut self, context: &Context, wishes: Vec<Wish>) {
        self.asked = wishes.iter().map(|wish| wish.entry.clone()).collect();
        if self.running.is_none() {
            let (orders, taken) = channel();
            let writer = Writer::new(self.folder.clone(), self.limit, self.news.answer(context));
            let thread = Builder::new().name("slot files".to_owned()).spawn(move || writer.work(&taken));
            match thread {
                Ok(thread) => self.running = Some(Running { orders, thread }),
                Err(error) => {
                    let words = (!self.has_failed).then(|| {
                        format!("Kept pictures will not come back: no thread could be started ({error})")
                    });
                    self.has_failed = true;
                    self.news.answer(context).give(News::NotWritten { id: None, words });
                }
            }
        }
        if let Some(running) = &self.running {
            // A thread that has panicked takes no more orders, and the log says why.
            let _ = running.orders.send(wishes);
        }
    }

    /// Has the files made those of the slots, tries again what has failed, and waits for it.
    pub fn finish(&mut self, slots: &Slots) {
        let wishes = self.wishes(slots);
        if self.running.is_some() || wishes.len() != self.asked.len() {
            // The last news need not wake a window.
            self.send(&Context::default(), wishes);
        }
        if let Some(Running { orders, thread }) = self.running.take() {
            drop(orders);
            let _ = thread.join();
        }
    }

    /// The oldest news that have not been taken yet.
    pub fn news(&self) -> Option<News> {
        self.news.take()
    }

    fn wishes(&self, slots: &Slots) -> Vec<Wish> {
        let used = slots.used().map(|(number, slot)| Wish {
            entry: Entry::of(number, slot),
            kept: Some(Arc::clone(&slot.kept)),
        });
        let awaited = slots.awaited().map(|(number, coming)| Entry::awaited(number, coming));
        let others = awaited.chain(self.spared.iter().cloned()).map(|entry| Wish { entry, kept: None });
        used.chain(others).collect()
    }
}

/// What the thread knows.
struct Writer {
    folder: Folder,
    limit: u64,
    news: Answer<News>,
    /// The pictures whose files are there.
    written: BTreeSet<String>,
    /// The list as it was written last.
    listed: Vec<Entry>,
    /// The pictures that there was no room for, with their bytes.
    refused: BTreeMap<String, u64>,
    /// The pictures that could not be written since the last order.
    failed: BTreeSet<String>,
    has_told: bool,
}

impl Writer {
    fn new(folder: Folder, limit: u64, news: Answer<News>) -> Self {
        Writer {
            folder,
            limit,
            news,
            written: BTreeSet::new(),
            listed: Vec::new(),
            refused: BTreeMap::new(),
            failed: BTreeSet::new(),
            has_told: false,
        }
    }

    /// Follows the newest order. A film that is being written is written to its end.
    fn work(mut self, orders: &Receiver<Vec<Wish>>) {
        give_way();
        while let Ok(mut wishes) = orders.recv() {
            loop {
                if let Some(newest) = orders.try_iter().last() {
                    wishes = newest;
                    self.failed.clear();
                }
                self.delete_others(&wishes);
                if !self.write_next(&wishes) {
                    break;
                }
            }
            self.failed.clear();
        }
    }

    /// Deletes the files of pictures that are in no slot any more, which makes room for others.
    fn delete_others(&mut self, wishes: &[Wish]) {
        let ids: BTreeSet<&String> = wishes.iter().map(|wish| &wish.entry.id).collect();
        self.refused.retain(|id, _| ids.contains(id));
        // What is being read is there.
        let on_disk = wishes.iter().filter(|wish| wish.kept.is_none()).map(|wish| wish.entry.id.clone());
        self.written.extend(on_disk);
        let gone: Vec<String> = self.written.iter().filter(|id| !ids.contains(id)).cloned().collect();
        self.written.retain(|id| ids.contains(id));
        // The list first: what it says must be there.
        self.write_list(wishes);
        gone.iter().for_each(|id| self.folder.delete(id));
        if self.written.is_empty() && !gone.is_empty() {
            let _ = self.folder.write_list(&[]);
        }
    }

    fn write_list(&mut self, wishes: &[Wish]) {
        let entries = wishes.iter().map(|wish| &wish.entry);
        let slots: Vec<Entry> = entries.filter(|entry| self.written.contains(&entry.id)).cloned().collect();
        if slots == self.listed {
            return;
        }
        match self.folder.write_list(&slots) {
            Ok(()) => self.listed = slots,
            Err(reason) => self.tell_failure(None, "Kept pictures", &reason),
        }
    }

    /// Writes the first picture that is not there yet. Returns whether there was one.
    fn write_next(&mut self, wishes: &[Wish]) -> bool {
        let room = self.limit.saturating_sub(self.folder.bytes_of_all());
        let is_missing = |wish: &&Wish| {
            let id = &wish.entry.id;
            let is_refused = self.refused.get(id).is_some_and(|bytes| *bytes > room);
            !self.written.contains(id) && !self.failed.contains(id) && !is_refused
        };
        let missing = wishes.iter().filter(|wish| wish.kept.is_some()).find(is_missing);
        let Some(Wish { entry, kept: Some(kept) }) = missing else { return false };
        match self.folder.write(kept, room) {
            Ok(bytes) => {
                log::info!("kept picture: {} in {}", words(bytes), self.folder.film(&entry.id).display());
                self.written.insert(entry.id.clone());
                self.has_told = false;
                self.write_list(wishes);
                self.news.give_one(News::Written(entry.id.clone()));
            }
            Err(WriteFault::TooLarge(bytes)) => {
                let is_news = self.refused.insert(entry.id.clone(), bytes).is_none();
                let words = is_news.then(|| self.too_large(entry, bytes, room));
                self.news.give_one(News::NotWritten { id: Some(entry.id.clone()), words });
            }
            Err(WriteFault::Failed(reason)) => {
                self.failed.insert(entry.id.clone());
                self.tell_failure(Some(&entry.id), &title(entry), &reason);
            }
        }
        true
    }

    fn too_large(&self, entry: &Entry, bytes: u64, room: u64) -> String {
        format!(
            "{} will not come back in the next window: its film takes {} on disk, where the kept pictures of \
             all windows may take {} and already take {}; delete a slot, or save this one as a film",
            title(entry),
            words(bytes),
            words(self.limit),
            words(self.limit - room)
        )
    }

    /// Says once that nothing can be written.
    fn tell_failure(&mut self, id: Option<&String>, what: &str, reason: &str) {
        let is_news = !std::mem::replace(&mut self.has_told, true);
        let words = is_news.then(|| format!("{what} will not come back in the next window: {reason}"));
        self.news.give_one(News::NotWritten { id: id.cloned(), words });
    }
}

fn title(entry: &Entry) -> String {
    match entry.number {
        Some(number) => format!("Slot {number} ({})", entry.name),
        None => entry.name.clone(),
    }
}
